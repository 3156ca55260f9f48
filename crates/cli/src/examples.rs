//! The examples of the help. A test reads every line of them as the program would.

/// Below the help of the program itself.
pub(crate) const PROGRAM: &str = "\
Examples:
  fieldstone render model.hf -o model.png
  fieldstone render -e 'x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 11.8' -o tangle.png --size 800x600
  fieldstone eval -e 'x^2 + y^2 + z^2 - 1' < points.txt
  fieldstone check model.hf

Models: HyperFun (.hf, .hpf; F >= 0 inside, y up), programs (.vm), surfaces of SURFER (.jsurf) and formulas
(any other file, or -e; f < 0 inside, z up). Scenes (.toml): docs/scenes.md. `fieldstone COMMAND --help` shows more examples.";

/// `render`.
pub(crate) const RENDER: &str = "\
Examples:
  A HyperFun file, in a view that fits it; then from where you like:
    fieldstone render model.hf -o model.png
    fieldstone render model.hf -o side.png --eye 14,20,24 --target 0,1,0 --fov 25

  A formula, negative inside, with a parameter of its own:
    fieldstone render -e 'r = 0.2; (1 - sqrt(x^2 + y^2))^2 + z^2 - r^2' -o ring.png --param r=0.4

  A solid without end: say where to cut it; --open looks inside:
    fieldstone render -e 'sin(x) + sin(y) + sin(z)' -o waves.png --bounds=-6,-6,-6,6,6,6 --open

  A surface without an inside, in a sphere, both sides of it; and the values of a field on a plane:
    fieldstone render -e 'x^2*y^2 + y^2*z^2 + z^2*x^2 + x*y*z' -o steiner.png --surface --clip-sphere 0,0,0,0.8
    fieldstone render model.hf -o cut.png --slice z=0.3

  One object of a file, its first parameter, and a fourth coordinate:
    fieldstone render model.hf -o part.png --object wheel --param a[1]=2 --coord 4=0.5

  A scene of many solids, materials and lights; at a time; and as the pictures of a film, with the numbers in ####:
    fieldstone render scene.toml -o scene.png
    fieldstone render scene.toml -o later.png --time 1.5 --size 1280x720
    fieldstone render scene.toml -o film_####.png --frames 0..47 --fps 24

  All layers (depth, normals, certificates) and the statistics of a large picture:
    fieldstone render model.hf -o model.exr --size 1920x1080 --samples 9 --stats stats.json";

/// `measure`.
pub(crate) const MEASURE: &str = "\
Examples:
  Volume, area, centroid and extent, each between two proved bounds; then for another program:
    fieldstone measure model.hf
    fieldstone measure model.hf --json

  More digits, and more time for them:
    fieldstone measure -e '(1 - sqrt(x^2 + y^2))^2 + z^2 - 0.125' --tolerance 1e-5 --effort 4

  What is in a box of a solid without end:
    fieldstone measure -e 'sin(x) + sin(y) + sin(z)' --bounds=-3,-3,-3,3,3,3

The area is that of the surface f = 0: faces where the bounds cut the solid count for the volume only. Where the gradient
may be 0 on the surface, the area has a lower bound only. Lengths are in the units of the model.";

/// `texel`.
pub(crate) const TEXEL: &str = "\
Examples:
  A volume from a recipe; the same, finer; by the rules of the paper of 1995:
    fieldstone texel build lawn.toml -o lawn.texel
    fieldstone texel build lawn.toml -o fine.texel --edge 256
    fieldstone texel build lawn.toml -o old.texel --filter 1995

  From a recipe that names files in another folder:
    fieldstone texel build relics.toml -o relics.texel --allow-read scans

  What is in it, and how far its coarser levels are from the finest:
    fieldstone texel info lawn.texel
    fieldstone texel compare lawn.texel --json
    fieldstone texel compare lawn.texel --sun 1,0,0.5 --csv

  All of it along y, a plane of it, and what the flakes of a coarser level look like:
    fieldstone texel slice lawn.texel -o lawn.png
    fieldstone texel slice lawn.texel -o plane.png --axis z --at 0.25
    fieldstone texel slice lawn.texel -o flakes.png --level 2 --show flakes";

/// `plot`.
pub(crate) const PLOT: &str = "\
Examples:
  The spans that the tracer looked at along a ray, with their bounds, the roots and what is proved of them:
    fieldstone plot model.hf --ray 0,0,10,0,0,-1 -o ray.svg
    fieldstone plot model.hf --ray 0,0,10,0,0,-1 --method interval -o ray.svg

  The ray through a pixel of the picture that `render` makes:
    fieldstone plot model.hf --through 200,120 --size 400x300 -o ray.png

  How tight the bounds are over 16 spans of the same length:
    fieldstone plot -e 'x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 11.8' --ray=-4,1,1,1,0,0 --spans 16 -o bounds.svg";

/// `convert`.
pub(crate) const CONVERT: &str = "\
Examples:
  A HyperFun model as a program of libfive and Fidget, and as a formula:
    fieldstone convert model.hf -o model.vm
    fieldstone convert model.hf -o model.txt

  A formula as HyperFun:
    fieldstone convert -e 'x^2 + y^2 + z^2 - 1' -o ball.hf

Parameters keep their names in formulas and are a[1], a[2], ... in HyperFun; programs have their values.
Coordinates are kept as they are: nothing is turned, although y is up in HyperFun and z in the others.
The sign becomes that of the language. Attributes are kept in HyperFun only.";

/// `bench`.
pub(crate) const BENCH: &str = "\
Examples:
  Frames of models, the gallery, and pictures beside POV-Ray's, in the folder of the sources:
    fieldstone bench
    fieldstone bench models --only building --size 1024 --view perspective -o building.json
    fieldstone bench povray --only table1/tangle.txt --pictures compared -o tangle.md

  How times and memory grow; how many instructions a few frames take, compared with the committed numbers:
    fieldstone bench growth
    fieldstone bench counts

Times are medians; ratios are those of pairs of runs that follow each other, with their quartiles. fidget is measured by a
program that was built with it: cargo build --release -p fieldstone-cli --features peers (Rust 1.95). POV-Ray and
valgrind must be installed.";

/// `schema`.
pub(crate) const SCHEMA: &str = "\
Examples:
  A schema beside the scenes; editors complete keys by it, and show what they mean:
    fieldstone schema > scene.schema.json
    fieldstone schema recipe > recipe.schema.json

  In editors with the TOML tools of Taplo, a scene names it in its first line:
    #:schema ./scene.schema.json";

/// `eval`.
pub(crate) const EVAL: &str = "\
Examples:
  Points come from standard input, one on a line; values go to standard output, in the sign of the file:
    fieldstone eval model.hf < points.txt
    echo '0 0 0.5' | fieldstone eval -e 'x^2 + y^2 + z^2 - 1'

  A slice: the fixed coordinate is left out of the points:
    fieldstone eval model.hf --coord 3=0.25 < plane.txt

  What the C interpreter would say, with a parameter:
    fieldstone eval model.hf --dialect strict --param a[1]=2 < points.txt

A line of the output has the value, then the attributes s[1], s[2], … if the object declares them, with tabs
between; `undefined` stands where there is no value.";

/// `check`.
pub(crate) const CHECK: &str = "\
Examples:
  Objects, parameters, bounds and warnings:
    fieldstone check model.hf
    fieldstone check -e 'r = 2; x^2 + y^2 + z^2 - r^2' --param r=3

  Another object of the file:
    fieldstone check model.hf --object wheel

  For other programs (an editor, a script); docs/check-json.md describes every field:
    fieldstone check model.hf --json

The exit code is 0 if the model can be read, with or without warnings, and 1 if not.";

/// `completions`.
pub(crate) const COMPLETIONS: &str = "\
Examples:
    fieldstone completions bash > ~/.local/share/bash-completion/completions/fieldstone
    fieldstone completions zsh > ~/.zfunc/_fieldstone
    fieldstone completions fish > ~/.config/fish/completions/fieldstone.fish";

/// `man`.
pub(crate) const MAN: &str = "\
Examples:
    fieldstone man ~/.local/share/man/man1
    man fieldstone-render";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::Arguments;
    use clap::Parser;

    /// The words of a line as a shell sees them, up to a redirection, with single quotes only.
    fn words(line: &str) -> Vec<String> {
        let mut words = vec![String::new()];
        for (i, part) in line.split('\'').enumerate() {
            if i % 2 == 1 {
                words.last_mut().expect("there is one").push_str(part);
                continue;
            }
            for (k, word) in part.split(' ').enumerate() {
                if k > 0 {
                    words.push(String::new());
                }
                words.last_mut().expect("there is one").push_str(word);
            }
        }
        words.retain(|word| !word.is_empty());
        let end = words.iter().position(|word| word == "<" || word == ">").unwrap_or(words.len());
        words.truncate(end);
        words
    }

    fn commands() -> impl Iterator<Item = &'static str> {
        let texts = [PROGRAM, RENDER, EVAL, CHECK, MEASURE, PLOT, TEXEL, CONVERT, SCHEMA, COMPLETIONS, MAN];
        let lines = texts.into_iter().flat_map(str::lines).map(str::trim);
        lines.filter_map(|line| match line.split_once("| ") {
            Some((_, piped)) => Some(piped),
            None => line.starts_with("fieldstone ").then_some(line),
        })
    }

    #[test]
    fn every_example_is_a_command_line() {
        let mut count = 0;
        for command in commands() {
            if let Err(error) = Arguments::try_parse_from(words(command)) {
                panic!("{command}\n{error}");
            }
            count += 1;
        }
        assert!(count > 25, "only {count} examples found");
    }

    /// The commands of a document: lines of code that begin with the program, perhaps behind a pipe, and those between
    /// backquotes.
    fn commands_of(text: &str) -> Vec<&str> {
        let indented = text.lines().filter_map(|line| line.strip_prefix("    "));
        let indented = indented.map(|line| line.split_once("' | ").map_or(line, |(_, piped)| piped));
        let quoted = text.lines().flat_map(|line| line.split('`').skip(1).step_by(2));
        let commands = indented.chain(quoted).filter(|command| command.starts_with("fieldstone "));
        let commands = commands.map(|command| command.split(" #").next().unwrap_or(command));
        // `fieldstone eval` alone is a name.
        commands.filter(|command| command.split_whitespace().count() > 2).collect()
    }

    #[test]
    fn every_command_in_the_documents_is_one() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let mut count = 0;
        let documents = [
            "README.md",
            "gallery/README.md",
            "docs/commands.md",
            "docs/gallery.md",
            "docs/performance.md",
            "docs/hyperfun.md",
            "docs/texels.md",
            "docs/hyperfun/tutorial.md",
        ];
        for document in documents {
            let text = std::fs::read_to_string(root.join(document)).unwrap();
            for command in commands_of(&text) {
                count += 1;
                match Arguments::try_parse_from(words(command)) {
                    Err(error) if error.exit_code() != 0 => panic!("{document}: {command}\n{error}"),
                    // `--help` is an error to the parser, with the exit code 0.
                    _ => {}
                }
            }
        }
        assert!(count > 50, "only {count} commands found");
    }

    #[test]
    fn a_wrong_example_would_be_noticed() {
        assert_eq!(words("a -e 'x + y' < points"), ["a", "-e", "x + y"]);
        assert!(Arguments::try_parse_from(words("fieldstone render model.hf --no-such -o a.png")).is_err());
        assert!(Arguments::try_parse_from(words("fieldstone render model.hf -o a.png --size 800")).is_err());
    }
}

//! What a writer probably meant.

/// What to write instead of a name that begins a statement in other languages.
pub(super) fn foreign_statement(word: &str) -> Option<&'static str> {
    Some(match word {
        "elseif" | "elsif" | "elif" => "write `else if … then … endif; endif;`",
        "for" | "do" | "repeat" => "loops are written `while … loop … endloop;`",
        "end" | "fi" => "`if` ends with `endif;`, `while` with `endloop;`",
        "endwhile" | "wend" | "done" => "`while … loop` ends with `endloop;`",
        "return" => "the value of an object is assigned to its own name",
        "var" | "let" | "real" | "float" | "double" | "int" => {
            "variables are not declared: they are assigned"
        }
        _ => return None,
    })
}

/// What to write instead of a name that is a constant in other languages.
pub(super) fn foreign_value(word: &str) -> Option<&'static str> {
    Some(match word {
        "pi" => "there is no constant `pi`: write 3.141592653589793 or assign it first",
        "e" => "there is no constant `e`: write `exp(1)`",
        "y" => "the coordinates are `x[1]`, `x[2]`, `x[3]`",
        "z" => "the coordinates are `x[1]`, `x[2]`, `x[3]`",
        "t" | "time" => "there is no time variable: use a coordinate `x[4]` or a parameter `a[1]`",
        "true" | "false" => "true is any number but 0, false is 0",
        _ => return None,
    })
}

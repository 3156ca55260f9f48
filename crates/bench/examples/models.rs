//! Writes the models that are measured into a folder: those that are kept there, or with `all` every one.
//!
//! ```text
//! cargo run --release -p fieldstone-bench --example models -- gallery/bench
//! cargo run --release -p fieldstone-bench --example models -- /tmp/models all
//! ```

use fieldstone_bench::MODELS;
use std::path::PathBuf;

fn main() -> std::io::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = PathBuf::from(arguments.first().map_or("gallery/bench", String::as_str));
    let all = arguments.get(1).is_some_and(|word| word == "all");
    std::fs::create_dir_all(&folder)?;
    for model in MODELS.iter().filter(|model| all || model.is_kept) {
        std::fs::write(folder.join(format!("{}.vm", model.name)), model.text())?;
    }
    Ok(())
}

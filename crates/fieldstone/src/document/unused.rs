//! Parameters, fields and materials are read whether something uses them or not, so that their mistakes are told.

use super::compose::Composer;
use super::fault::Outcome;
use super::number::Numbers;

/// Reads all parameters, fields and materials of a document at a time.
pub(super) fn check(numbers: &Numbers<'_>) -> Outcome<()> {
    let root = &numbers.document().root;
    for entry in root.entries_of("parameters") {
        numbers.parameter(&entry.key, &entry.value)?;
    }
    let mut composer = Composer::new(numbers);
    let space = composer.space();
    for entry in root.entries_of("fields") {
        composer.field(&entry.key, &entry.value, &space)?;
    }
    for entry in root.entries_of("materials") {
        // Of which model the attributes are is not known.
        composer.material_of(entry, &space, None)?;
    }
    Ok(())
}

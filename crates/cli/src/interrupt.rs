//! Ctrl-C: the first asks the work to stop, the second ends the program at once. Neither leaves half a file: while
//! files are written the program goes on, which does not take long.

use crate::failure::Failure;
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Work that goes on for longer after the first Ctrl-C deserves a word.
const PATIENCE: Duration = Duration::from_secs(1);

/// Whether the user pressed Ctrl-C since this was made.
pub(crate) struct Interrupt {
    asked: Arc<AtomicBool>,
    is_writing: Arc<AtomicBool>,
}

impl Interrupt {
    /// Listens from now on. Where that is impossible, Ctrl-C ends the program as it always does.
    pub(crate) fn listen() -> Self {
        let interrupt = Self { asked: Arc::default(), is_writing: Arc::default() };
        let (asked, is_writing) = (Arc::clone(&interrupt.asked), Arc::clone(&interrupt.is_writing));
        let _ = ctrlc::set_handler(move || {
            let is_second = asked.swap(true, Ordering::SeqCst);
            if is_second && !is_writing.load(Ordering::SeqCst) {
                eprintln!("{}", Failure::Interrupted);
                std::process::exit(i32::from(Failure::Interrupted.code()));
            }
            if !is_second && std::io::stderr().is_terminal() {
                std::thread::spawn(advise);
            }
        });
        interrupt
    }

    /// Becomes true when the work is to stop.
    pub(crate) fn flag(&self) -> &AtomicBool {
        &self.asked
    }

    /// Writes files, unless the work was to stop; from then on Ctrl-C waits until they are there.
    pub(crate) fn writing(&self, write: impl FnOnce() -> Result<(), Failure>) -> Result<(), Failure> {
        // In this order: a second Ctrl-C in between ends the program before there is a file, or not at all.
        self.is_writing.store(true, Ordering::SeqCst);
        let outcome = if self.asked.load(Ordering::SeqCst) { Err(Failure::Interrupted) } else { write() };
        self.is_writing.store(false, Ordering::SeqCst);
        outcome
    }
}

/// Says what to do if the program is still there after a while.
fn advise() {
    std::thread::sleep(PATIENCE);
    eprintln!("\nstopping at the next chance; press Ctrl-C again to stop at once");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_written_after_an_interrupt() {
        let interrupt = Interrupt { asked: Arc::default(), is_writing: Arc::default() };
        let mut count = 0;
        let mut write = || {
            assert!(interrupt.is_writing.load(Ordering::SeqCst));
            count += 1;
            Ok(())
        };
        assert!(interrupt.writing(&mut write).is_ok());
        interrupt.asked.store(true, Ordering::SeqCst);
        assert!(matches!(interrupt.writing(&mut write), Err(Failure::Interrupted)));
        assert_eq!(count, 1);
        assert!(!interrupt.is_writing.load(Ordering::SeqCst));
    }
}

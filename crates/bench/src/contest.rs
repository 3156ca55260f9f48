//! Contestants draw the same frames in turn; what counts is how their times compare within a pair.

use crate::error::BenchError;
use crate::timing::Times;
use std::time::Instant;

/// Somebody who draws frames of a walk around a model, in memory.
pub trait Contestant {
    /// Who it is: `fieldstone`, `fidget jit`.
    fn name(&self) -> &'static str;

    /// Draws a frame: this is what is timed. Each frame is another camera of the walk.
    ///
    /// # Errors
    /// Whatever keeps it from drawing.
    fn draw(&mut self, frame: u32) -> Result<(), BenchError>;

    /// Which pixels of the last frame show the solid, row by row from the top; `None` if that says nothing.
    fn silhouette(&self) -> Option<Vec<bool>>;

    /// How long it took to get from the text of the model to where frames can be drawn, in seconds.
    fn setup_seconds(&self) -> f64;
}

/// What a contest found out about one of those who took part.
#[derive(Clone, Debug)]
pub struct Standing {
    /// Who it is.
    pub name: &'static str,
    /// How long it took to prepare, in seconds.
    pub setup_seconds: f64,
    /// Seconds for each frame.
    pub times: Times,
    /// In which part of the pixels of the first frame its silhouette differs from that of the first contestant; `None` where
    /// there is nothing to compare.
    pub different: Option<f64>,
}

/// Lets everybody draw one frame untimed, then `runs` frames in turn; who begins changes from frame to frame.
///
/// # Errors
/// The first failure of a contestant.
pub fn contest(contestants: &mut [Box<dyn Contestant + '_>], runs: u32) -> Result<Vec<Standing>, BenchError> {
    for contestant in contestants.iter_mut() {
        contestant.draw(0)?;
    }
    let silhouettes: Vec<Option<Vec<bool>>> = contestants.iter().map(|c| c.silhouette()).collect();
    let mut seconds = vec![Vec::new(); contestants.len()];
    for frame in 1..=runs {
        for turn in 0..contestants.len() {
            let who = (turn + frame as usize) % contestants.len();
            let start = Instant::now();
            contestants[who].draw(frame)?;
            seconds[who].push(start.elapsed().as_secs_f64());
        }
    }
    let mut standings = Vec::new();
    for ((contestant, seconds), silhouette) in contestants.iter().zip(seconds).zip(&silhouettes) {
        standings.push(Standing {
            name: contestant.name(),
            setup_seconds: contestant.setup_seconds(),
            times: Times::new(seconds),
            different: different(&silhouettes[0], silhouette),
        });
    }
    Ok(standings)
}

/// The part of the pixels in which two silhouettes differ.
fn different(ours: &Option<Vec<bool>>, theirs: &Option<Vec<bool>>) -> Option<f64> {
    let (ours, theirs) = (ours.as_ref()?, theirs.as_ref()?);
    let differ = ours.iter().zip(theirs).filter(|(a, b)| a != b).count();
    (ours.len() == theirs.len() && !ours.is_empty()).then(|| differ as f64 / ours.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Sleeper {
        drawn: Vec<u32>,
        hit: bool,
    }

    impl Contestant for Sleeper {
        fn name(&self) -> &'static str {
            "sleeper"
        }

        fn draw(&mut self, frame: u32) -> Result<(), BenchError> {
            self.drawn.push(frame);
            if frame == 9 { Err(BenchError::peer("sleeper", "tired")) } else { Ok(()) }
        }

        fn silhouette(&self) -> Option<Vec<bool>> {
            Some(vec![self.hit, true, false, false])
        }

        fn setup_seconds(&self) -> f64 {
            0.5
        }
    }

    fn two() -> Vec<Box<dyn Contestant>> {
        [true, false].map(|hit| -> Box<dyn Contestant> { Box::new(Sleeper { drawn: vec![], hit }) }).into()
    }

    #[test]
    fn all_draw_the_same_frames() {
        let results = contest(&mut two(), 5).unwrap();
        assert!(results.iter().all(|result| result.times.seconds().len() == 5));
        assert_eq!(results.iter().map(|r| r.different).collect::<Vec<_>>(), [Some(0.0), Some(0.25)]);
    }

    #[test]
    fn a_failure_is_told() {
        assert_eq!(contest(&mut two(), 12).unwrap_err().to_string(), "sleeper: tired");
    }
}

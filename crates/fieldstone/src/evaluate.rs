//! Values of models at many points.

use crate::inputs::{InputError, Inputs};
use fieldstone_field::{F64, Input, LANES, Points, Tape, TapeOptions, Workspace};
use fieldstone_lang::{FileSign, Model};

/// Evaluates a model at points.
#[derive(Debug)]
pub struct Evaluator {
    tape: Tape,
    workspace: Workspace<F64, Points>,
    columns: usize,
    sign: FileSign,
}

impl Evaluator {
    /// Prepares the evaluation of a model in which the coordinates named by `inputs` are fixed.
    ///
    /// # Errors
    /// Inputs that the model does not have.
    pub fn new(model: &Model, inputs: &Inputs) -> Result<Self, InputError> {
        let bindings = inputs.bindings(model)?;
        let is_fixed = |index: usize| inputs.coordinates.iter().any(|(number, _)| *number == index + 1);
        let coordinates = (0..model.coordinates).filter(|&index| !is_fixed(index));
        let varying: Vec<Input> =
            coordinates.filter_map(|index| u16::try_from(index).ok()).map(Input::Coordinate).collect();
        let columns = varying.len();
        let options =
            TapeOptions { varying, bindings, attributes: model.has_attributes, ..TapeOptions::default() };
        let tape = Tape::new(&model.field, &options);
        Ok(Self { tape, workspace: Workspace::new(), columns, sign: model.sign })
    }

    /// How many numbers a point has: the coordinates of the model that are not fixed.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// How many numbers a result has: the value, then the attributes if the model declares any.
    pub fn outputs(&self) -> usize {
        self.tape.output_count()
    }

    /// Appends the results at points that stand one after the other, [`columns`](Self::columns) numbers each, to
    /// `results`: [`outputs`](Self::outputs) numbers each. The value has the sign of the model's file; NaN stands for
    /// what is undefined.
    ///
    /// A model without open coordinates has one point. Numbers that do not make a whole point are left out.
    pub fn evaluate(&mut self, points: &[f64], results: &mut Vec<f64>) {
        if self.columns == 0 {
            self.block(1, results);
            return;
        }
        for block in points.chunks(self.columns * LANES) {
            let lanes = block.len() / self.columns;
            for column in 0..self.columns {
                let row = self.workspace.input(column, 0);
                for (lane, point) in block.chunks_exact(self.columns).enumerate() {
                    row[lane] = point[column];
                }
            }
            self.block(lanes, results);
        }
    }

    fn block(&mut self, lanes: usize, results: &mut Vec<f64>) {
        self.workspace.run(&self.tape, lanes);
        for lane in 0..lanes {
            for output in 0..self.tape.output_count() {
                let value = self.workspace.output(output, 0)[lane];
                // 0 − value and not −value: there is no use for a negative zero.
                let turned = output == 0 && self.sign == FileSign::PositiveInside;
                results.push(if turned { 0.0 - value } else { value });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula;

    #[test]
    fn many_blocks_in_order() {
        let model = formula("x + 10*y + 100*z").unwrap().model;
        let mut evaluator = Evaluator::new(&model, &Inputs::default()).unwrap();
        let points: Vec<f64> = (0..150).flat_map(|i| [f64::from(i), 1.0, 2.0]).collect();
        let mut results = Vec::new();
        evaluator.evaluate(&points, &mut results);
        let expected: Vec<f64> = (0..150).map(|i| f64::from(i) + 210.0).collect();
        assert_eq!(results, expected);
    }

    #[test]
    fn fixed_coordinates_are_left_out() {
        let model = formula("x + 10*y + 100*z + 1000*w").unwrap().model;
        let inputs = Inputs { coordinates: vec![(4, 3.0), (2, 5.0)], ..Inputs::default() };
        let mut evaluator = Evaluator::new(&model, &inputs).unwrap();
        assert_eq!((evaluator.columns(), evaluator.outputs()), (2, 1));
        let mut results = Vec::new();
        evaluator.evaluate(&[1.0, 2.0], &mut results);
        assert_eq!(results, [3251.0]);
        let all = Inputs { coordinates: (1..=4).map(|k| (k, 1.0)).collect(), ..Inputs::default() };
        let mut evaluator = Evaluator::new(&model, &all).unwrap();
        results.clear();
        evaluator.evaluate(&[], &mut results);
        assert_eq!(results, [1111.0]);
    }
}

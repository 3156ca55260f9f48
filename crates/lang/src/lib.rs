//! Front ends of Fieldstone: HyperFun, formulas and .vm programs.

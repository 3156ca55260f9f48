//! A model for every function of the library, for tests and measurements.

use fieldstone_field::Field;
use fieldstone_lang::{Dialect, HyperFunOptions, Source, parse_hyperfun};

/// The arrays and numbers that the cases name.
const PREAMBLE: &str = "
  array c[3]; array d[3]; array p0[2]; array p1[2]; array p2[2]; array w1[2]; array w2[2]; array b1[6]; array b2[6];
  array sv[2]; array r1[1]; array th[1]; array ax[3]; array an[1]; array s1[1]; array tri[9]; array ti[3];
  array cur[9]; array bb[6]; array cp12[12]; array o1[3]; array n3[3]; array m9[9]; array m5[15]; array m6[6];
  array b3[6]; array d3[3]; array c3[3]; array m3[3]; array xt[3]; array ui[3]; array hi[3];
  c=[0.2,0.1,-0.3]; d=[0.5,1,-2]; p0=[0,1]; p1=[0,0.5]; p2=[0.2,1]; w1=[1.5,2]; w2=[0.8,1.1];
  b1=[0,0,0,1,0,0]; b2=[0,0,1,1,1,1]; sv=[1.2,0.9]; r1=[1.5]; th=[90]; ax=[0,0,1]; an=[30]; s1=[0.8];
  tri=[0,0,0,1,0,0,0,1,0.5]; ti=[1,2,3]; cur=[0,0,0,1,0,0,1,1,1]; bb=[-1,-1,-1,2,2,2];
  cp12=[1,2,3,4,5,6,7,8,9,10,11,12]; o1=[0.2,0.4,0.6]; n3=[0,0.5,1]; m9=[1,0,0,0,1,0,0,0,1];
  m5=[0,0,0,1,2,3,4,1,0,2,2,2,5,6,7]; m6=[1,0,0,0,1,0]; b3=[2,2,2,3,3,3]; d3=[1,1,1]; c3=[0.5,0.5,0.5];
  m3=[0,0,1]; s[1]=0; s[2]=0; s[3]=0; xt[1]=x[1]; xt[2]=x[2]; xt[3]=x[3];
  u = 0.5*x[1] + 0.2*x[2] - 0.1*x[3] + 0.1; w = 0.3*x[2] - 0.4*x[3] + 0.05;
  ui[1]=0.5+0.2*x[1]; ui[2]=0.5+0.2*x[2]; ui[3]=0.5+0.2*x[3]; hi[1]=180+80*x[1]; hi[2]=0.5+0.2*x[2]; hi[3]=0.5+0.2*x[3];
";

/// A function of the library and a model that calls it.
pub(crate) struct Case {
    /// The name in lower case.
    pub(crate) name: &'static str,
    /// The statements that set v.
    pub(crate) statements: &'static str,
}

impl Case {
    /// The model in a dialect.
    pub(crate) fn field(&self, dialect: Dialect) -> Result<Field, String> {
        let text = format!("my_model(x[3], a[1], s[3]) {{ {PREAMBLE} {} my_model = v; }}", self.statements);
        let options = HyperFunOptions { object: None, dialect };
        let model = parse_hyperfun(&Source::new(self.name, text), &options).map_err(|e| e.to_string())?;
        Ok(model.field)
    }
}

/// All cases.
pub(crate) fn cases() -> impl Iterator<Item = Case> {
    let lines = include_str!("cases.txt").lines().filter(|line| !line.starts_with('#'));
    lines.map(|line| {
        let (name, statements) = line.split_once(": ").expect("a name and statements");
        Case { name, statements }
    })
}

/// A reproducible stream of numbers (SplitMix64).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// From 0 to 1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

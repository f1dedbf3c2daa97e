//! Statements `t`: what is sharp, and by which rules a control mesh is refined.
//!
//! `t NAME i/f/s` is followed by i whole numbers, f numbers and s words, as in the
//! regression shapes of OpenSubdiv. Vertices and faces are counted from 0.

use crate::{
    error::ErrorKind,
    text::{Words, float, integer, quote},
};
use karui::subdiv::{Boundary, Corner, Crease, CreaseMethod, FaceVaryingRule, Rules, TriangleRule};

/// What has been read so far.
#[derive(Default)]
pub(super) struct Tags {
    pub creases: Vec<Crease>,
    pub corners: Vec<Corner>,
    pub holes: Vec<u32>,
    pub rules: Rules,
    /// The first tag that was not understood.
    pub unknown: Option<String>,
}

/// The arguments of one tag.
struct Arguments<'a> {
    whole: Vec<u32>,
    numbers: Vec<f32>,
    words: Vec<&'a [u8]>,
}

impl Tags {
    /// Reads what follows `t`.
    pub fn read(&mut self, mut words: Words<'_>) -> Result<(), ErrorKind> {
        let name = words.next().unwrap_or_default();
        let arguments = Arguments::read(words)?;
        match name {
            b"crease" => self.crease(&arguments)?,
            b"corner" => self.corner(&arguments)?,
            b"hole" => self.holes.extend(&arguments.whole),
            b"interpolateboundary" => {
                let all = [Boundary::None, Boundary::EdgeAndCorner, Boundary::EdgeOnly];
                self.rules.boundary = Some(arguments.choice(&all)?);
            }
            b"facevaryinginterpolateboundary" => {
                self.rules.face_varying = Some(arguments.choice(&FACE_VARYING)?);
            }
            b"creasemethod" => self.rules.creases = Some(arguments.crease_method()?),
            b"smoothtriangles" => self.rules.triangles = Some(arguments.triangle_rule()?),
            other => {
                self.unknown.get_or_insert_with(|| quote(other));
            }
        }
        Ok(())
    }

    /// Pairs of vertices, with a sharpness each or one for all.
    fn crease(&mut self, arguments: &Arguments<'_>) -> Result<(), ErrorKind> {
        for (i, pair) in arguments.whole.chunks_exact(2).enumerate() {
            self.creases.push(Crease {
                vertices: [pair[0], pair[1]],
                sharpness: arguments.sharpness(i)?,
            });
        }
        Ok(())
    }

    fn corner(&mut self, arguments: &Arguments<'_>) -> Result<(), ErrorKind> {
        for (i, &vertex) in arguments.whole.iter().enumerate() {
            let sharpness = arguments.sharpness(i)?;
            self.corners.push(Corner { vertex, sharpness });
        }
        Ok(())
    }
}

const FACE_VARYING: [FaceVaryingRule; 6] = [
    FaceVaryingRule::None,
    FaceVaryingRule::CornersOnly,
    FaceVaryingRule::CornersPlus1,
    FaceVaryingRule::CornersPlus2,
    FaceVaryingRule::Boundaries,
    FaceVaryingRule::All,
];

impl<'a> Arguments<'a> {
    fn read(mut words: Words<'a>) -> Result<Self, ErrorKind> {
        let counts = words.next().unwrap_or_default();
        let wrong = || ErrorKind::syntax("three counts such as 2/1/0", quote(counts));
        let count = |part: &[u8]| integer(part).and_then(|n| usize::try_from(n).ok());
        let counts: Option<Vec<usize>> = counts.split(|&b| b == b'/').map(count).collect();
        let Some([whole, numbers, strings]) = counts.as_deref() else {
            return Err(wrong());
        };
        let mut take = |count: usize, what: &'static str| -> Result<Vec<&'a [u8]>, ErrorKind> {
            let found: Vec<_> = words.by_ref().take(count).collect();
            if found.len() == count {
                return Ok(found);
            }
            Err(ErrorKind::syntax(
                format!("{count} {what}"),
                found.len().to_string(),
            ))
        };
        let whole = take(*whole, "whole numbers")?.into_iter().map(index);
        let whole = whole.collect::<Result<_, _>>()?;
        let numbers = take(*numbers, "numbers")?.into_iter();
        let numbers = numbers
            .map(|word| float(word, "sharpness"))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            whole,
            numbers,
            words: take(*strings, "words")?,
        })
    }

    fn sharpness(&self, i: usize) -> Result<f32, ErrorKind> {
        let found = self.numbers.get(i).or(self.numbers.first());
        found
            .copied()
            .ok_or_else(|| ErrorKind::syntax("a sharpness", "none"))
    }

    /// The one of `all` that the first number names.
    fn choice<T: Copy>(&self, all: &[T]) -> Result<T, ErrorKind> {
        let found = self.whole.first().and_then(|&i| all.get(i as usize));
        let wrong = || {
            let given = self.whole.first().map_or("none".into(), u32::to_string);
            ErrorKind::syntax(format!("a number from 0 to {}", all.len() - 1), given)
        };
        found.copied().ok_or_else(wrong)
    }

    fn crease_method(&self) -> Result<CreaseMethod, ErrorKind> {
        match self.words.first().copied().unwrap_or_default() {
            b"normal" => Ok(CreaseMethod::Uniform),
            b"chaikin" => Ok(CreaseMethod::Chaikin),
            other => Err(ErrorKind::syntax("`normal` or `chaikin`", quote(other))),
        }
    }

    fn triangle_rule(&self) -> Result<TriangleRule, ErrorKind> {
        match self.words.first().copied().unwrap_or_default() {
            b"catmark" | b"normal" => Ok(TriangleRule::CatmullClark),
            b"smooth" => Ok(TriangleRule::Smooth),
            other => Err(ErrorKind::syntax("`catmark` or `smooth`", quote(other))),
        }
    }
}

fn index(word: &[u8]) -> Result<u32, ErrorKind> {
    let found = integer(word).and_then(|n| u32::try_from(n).ok());
    found.ok_or_else(|| ErrorKind::syntax("a number of a vertex or face, from 0", quote(word)))
}

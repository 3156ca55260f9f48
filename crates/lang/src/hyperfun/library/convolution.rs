//! Skeletons convolved with the Cauchy kernel 1/(1 + S²r²)², after McCormack and Sherstyuk.
//!
//! The closed forms are rearranged so that denominators are sums of squares, which stay away from 0 over intervals,
//! and so that no removable singularity is left. What remains undefined: a width S = 0 (a kernel that is 1
//! everywhere). Skeletons without extent (segments of length 0, triangles without an area) add nothing.

use super::call::{Call, Outcome};
use super::expression::{Expr, Vector};

/// hfConvPoint: Σ 1/(1 + S²r²)² − T.
pub(super) fn point<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let (x, widths) = (call.point(0)?, call.array(2));
    let points = call.vectors_of(1, widths.len())?;
    let kernels = points.iter().zip(&widths).map(|(&p, &s)| cauchy((x - p).squared(), s).square());
    Ok(call.sum(kernels.map(|k| 1.0 / k)) - call.real(3))
}

/// 1 + S²r².
fn cauchy<'g>(squared_distance: Expr<'g>, s: Expr<'g>) -> Expr<'g> {
    1.0 + s.square() * squared_distance
}

/// hfConvLine: separate segments.
pub(super) fn line<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let (x, widths) = (call.point(0)?, call.array(3));
    let (begins, ends) = (call.vectors_of(1, widths.len())?, call.vectors_of(2, widths.len())?);
    let segments = (0..widths.len()).map(|i| segment(x, begins[i], ends[i], widths[i]));
    Ok(call.sum(segments) - call.real(4))
}

/// hfConvCurve: the segments of a polyline, a width for each.
pub(super) fn curve<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let (x, widths) = (call.point(0)?, call.array(2));
    let vertices = call.vectors_of(1, widths.len() + 1)?;
    let segments = (0..widths.len()).map(|i| segment(x, vertices[i], vertices[i + 1], widths[i]));
    Ok(call.sum(segments) - call.real(3))
}

/// hfConvLineR: segments with the threshold at which the last one, seen from its end, has radius R. The sum counts
/// up to 1 only, after each segment.
pub(super) fn line_of_radius<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let (x, ends) = (call.point(0)?, call.vectors(2)?);
    let begins = call.vectors_of(1, ends.len())?;
    let radius = call.real(3);
    let s = radius.lt(1.0).select(1.0 / radius, 1.0);
    let (mut sum, mut threshold) = (call.number(0.0), call.number(0.0));
    for (&begin, &end) in begins.iter().zip(&ends) {
        sum = (sum + segment(x, begin, end, s)).min(1.0);
        let (length, near) = ((end - begin).length(), cauchy(radius.square(), s));
        let far = near + s.square() * length.square();
        let root = near.sqrt();
        threshold = length / (2.0 * near * far) + (s * length / root).atan() / (2.0 * s * near * root);
    }
    Ok(sum - threshold)
}

/// The convolution of a segment:
/// h/(2P²B²) + (l − h)/(2P²Q²) + (atan(Sh/P) + atan(S(l − h)/P))/(2SP³),
/// where P², B² and Q² are 1 + S²r² for the distances from the line, the beginning and the end.
fn segment<'g>(x: Vector<'g>, begin: Vector<'g>, end: Vector<'g>, s: Expr<'g>) -> Expr<'g> {
    let length = (end - begin).length();
    let direction = (end - begin).unit();
    let from_begin = x - begin;
    let (h, rest) = (from_begin.dot(direction), (end - x).dot(direction));
    let p2 = cauchy(from_begin.cross(direction).squared(), s);
    let (b2, q2) = (cauchy(from_begin.squared(), s), cauchy((x - end).squared(), s));
    let p = p2.sqrt();
    let ends = (h / b2 + rest / q2) / (2.0 * p2);
    let angles = (s * h / p).atan() + (s * rest / p).atan();
    length.eq(0.0).select(0.0, ends + angles / (2.0 * s * p2 * p))
}

/// hfConvTriangle: triangles of three points each.
pub(super) fn triangles<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let (x, widths) = (call.point(0)?, call.array(2));
    let v = call.vectors_of(1, 3 * widths.len())?;
    let all = widths.iter().enumerate().map(|(i, &s)| triangle(x, [v[3 * i], v[3 * i + 1], v[3 * i + 2]], s));
    Ok(call.sum(all) - call.real(3))
}

/// hfConvMesh: triangles of three numbers of points each, counted from 1.
pub(super) fn mesh<'g>(call: &mut Call<'g>) -> Outcome<'g> {
    let (x, vertices, widths) = (call.point(0)?, call.vectors(1)?, call.array(3));
    let numbers = call.array_of(2, 3 * widths.len())?;
    let corners = numbers.iter().map(|&n| vertex(call, &vertices, n)).collect::<Result<Vec<_>, _>>()?;
    let all = corners.chunks_exact(3).zip(&widths).map(|(v, &s)| triangle(x, [v[0], v[1], v[2]], s));
    Ok(call.sum(all) - call.real(4))
}

fn vertex<'g>(call: &Call<'g>, vertices: &[Vector<'g>], number: Expr<'g>) -> Result<Vector<'g>, String> {
    let name = call.name(2);
    let number =
        number.constant_value().ok_or_else(|| format!("the elements of `{name}` must be constants"))?;
    let nearest = (number + 0.5).floor();
    if nearest >= 1.0 && nearest <= vertices.len() as f64 {
        return Ok(vertices[nearest as usize - 1]);
    }
    Err(format!("`{name}` holds {number}, but there are {} points", vertices.len()))
}

/// S³ times the convolution of a triangle (the factor is the C library's), in the plane frame (u, v) whose origin is the
/// foot of the height on the longest edge: that edge reaches from u = −a₁ to u = a₂, and the third corner is at v = h.
fn triangle<'g>(x: Vector<'g>, corners: [Vector<'g>; 3], s: Expr<'g>) -> Expr<'g> {
    let [c1, c2, c3] = longest_edge_first(corners);
    let along = (c2 - c1).unit();
    let foot = c1 + along * (c3 - c1).dot(along);
    let (a1, a2, h) = ((foot - c1).length(), (c2 - foot).length(), (c3 - foot).length());
    let across = (c3 - foot).unit();
    let d = x - foot;
    let (u, v, height) = (d.dot(along), d.dot(across), d.dot(along.cross(across)));

    let q = 1.0 / s.square() + height.square();
    let g = v - h;
    let (k, m) = (u * h - a1 * g, a2 * g + u * h);
    let left =
        edge(k, (q * (a1.square() + h.square()) + k.square()).sqrt(), a1 * (a1 + u) + v * h, -a1 * u - g * h);
    let right =
        edge(m, (q * (a2.square() + h.square()) + m.square()).sqrt(), -a2 * (a2 - u) - v * h, g * h - a2 * u);
    let base = edge(v, (q + v.square()).sqrt(), a1 + u, a2 - u);
    h.eq(0.0).select(0.0, (left + right + base) / (2.0 * q * s))
}

/// w·(atan(p/r) + atan(q/r))/r.
fn edge<'g>(w: Expr<'g>, r: Expr<'g>, p: Expr<'g>, q: Expr<'g>) -> Expr<'g> {
    w * ((p / r).atan() + (q / r).atan()) / r
}

/// The corners in the same cyclic order, those of the longest edge first.
fn longest_edge_first<'g>([a, b, c]: [Vector<'g>; 3]) -> [Vector<'g>; 3] {
    let [ab, bc, ca] = [(b - a).squared(), (c - b).squared(), (a - c).squared()];
    let (first, second) = (bc.le(ab).and(ca.le(ab)), ca.le(bc));
    let pick = |p: Vector<'g>, q: Vector<'g>, r: Vector<'g>| p.where_else(first, q.where_else(second, r));
    [pick(a, b, c), pick(b, c, a), pick(c, a, b)]
}

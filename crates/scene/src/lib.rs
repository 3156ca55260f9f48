//! What there is to draw, resolved; cameras, lights, film.

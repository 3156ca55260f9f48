//! First hits of rays with fields, with a certificate.

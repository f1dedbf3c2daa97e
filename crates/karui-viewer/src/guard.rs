//! Who is answered, and what every answer says about itself.

use crate::shared::Shared;
use crate::token::same;
use axum::extract::{Request, State};
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, HOST, HeaderValue, ORIGIN, REFERRER_POLICY,
    X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{HeaderMap, HeaderName, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse as _, Response};
use std::sync::Arc;

/// Answers those who know the token and call the server by its own name.
pub async fn guard(State(shared): State<Arc<Shared>>, request: Request, next: Next) -> Response {
    let mut response = match refusal(&shared, &request) {
        Some(status) => status.into_response(),
        None => next.run(request).await,
    };
    protect(response.headers_mut(), shared.port);
    response
}

fn refusal(shared: &Shared, request: &Request) -> Option<StatusCode> {
    // The name first: to a stranger's page, every address looks alike.
    if !named_right(request.headers(), shared.port) {
        return Some(StatusCode::FORBIDDEN);
    }
    let mut parts = request.uri().path().split('/');
    let token = parts.nth(1).unwrap_or_default();
    (!same(&shared.token, token)).then_some(StatusCode::NOT_FOUND)
}

/// Whether the request was made out to this server, and by its own page if by a page.
fn named_right(headers: &HeaderMap, port: u16) -> bool {
    let Some(host) = only(headers, &HOST) else {
        return false;
    };
    let known = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{port}"));
    let same_origin = match headers.contains_key(ORIGIN) {
        true => only(headers, &ORIGIN).is_some_and(|o| o.strip_prefix("http://") == Some(host)),
        false => true,
    };
    known.iter().any(|name| name == host) && same_origin
}

/// The value of a header that must not be there twice.
fn only<'a>(headers: &'a HeaderMap, name: &HeaderName) -> Option<&'a str> {
    let mut values = headers.get_all(name).iter();
    let first = values.next()?.to_str().ok()?;
    values.next().is_none().then_some(first)
}

fn protect(headers: &mut HeaderMap, port: u16) {
    let policy = format!(
        "default-src 'self'; img-src 'self' blob: data:; \
         connect-src 'self' blob: ws://127.0.0.1:{port} ws://localhost:{port}; \
         worker-src 'self' blob:; style-src 'self' 'unsafe-inline'; object-src 'none'; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    );
    // A port is digits, which no header forbids.
    if let Ok(policy) = HeaderValue::from_str(&policy) {
        headers.insert(CONTENT_SECURITY_POLICY, policy);
    }
    let fixed = [
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (REFERRER_POLICY, "no-referrer"),
        (CACHE_CONTROL, "no-store"),
        (
            HeaderName::from_static("cross-origin-resource-policy"),
            "same-origin",
        ),
    ];
    for (name, value) in fixed {
        headers.insert(name, HeaderValue::from_static(value));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(pairs: &[(HeaderName, &str)]) -> HeaderMap {
        let value = |v: &str| HeaderValue::from_str(v).unwrap();
        let mut map = HeaderMap::new();
        for (name, v) in pairs {
            map.append(name.clone(), value(v));
        }
        map
    }

    #[test]
    fn only_its_own_names() {
        let right = |pairs: &[(HeaderName, &str)]| named_right(&headers(pairs), 80);
        assert!(right(&[(HOST, "127.0.0.1:80")]));
        assert!(right(&[
            (HOST, "localhost:80"),
            (ORIGIN, "http://localhost:80")
        ]));
        assert!(!right(&[]));
        for host in ["127.0.0.1", "127.0.0.1:81", "evil.example:80", "[::1]:80"] {
            assert!(!right(&[(HOST, host)]), "{host}");
        }
        for origin in ["null", "https://localhost:80", "http://127.0.0.1:80", ""] {
            assert!(
                !right(&[(HOST, "localhost:80"), (ORIGIN, origin)]),
                "{origin}"
            );
        }
        let twice = (HOST, "localhost:80");
        assert!(!right(&[twice.clone(), twice]));
    }
}

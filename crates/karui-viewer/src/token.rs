//! What an address has to contain to be answered.

use crate::error::{Error, Result};

/// 128 random bits in hexadecimal digits.
pub fn random_token() -> Result<String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(|e| Error::Random(e.to_string()))?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Whether both are the same, in a time that does not tell how far they agree.
pub fn same(token: &str, other: &str) -> bool {
    let bytes = token.bytes().zip(other.bytes());
    token.len() == other.len() && bytes.fold(0, |sum, (a, b)| sum | (a ^ b)) == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_are_the_same() {
        let [a, b] = [random_token().unwrap(), random_token().unwrap()];
        assert_eq!(a.len(), 32);
        assert!(a.bytes().all(|c| c.is_ascii_hexdigit()));
        assert!(!same(&a, &b) && same(&a, &a));
        assert!(!same(&a, &a[..31]) && !same(&a, ""));
    }
}

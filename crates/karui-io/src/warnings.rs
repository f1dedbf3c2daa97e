//! What a reader passed over without failing.

/// Messages kept; a damaged file could otherwise cause millions.
const KEPT: usize = 100;

/// Things in a file that were passed over or replaced, in the order they were
/// met. Equal messages are kept once.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Warnings {
    messages: Vec<String>,
    dropped: usize,
}

impl Warnings {
    /// Adds a message unless it is there already.
    pub fn push(&mut self, message: impl Into<String>) {
        let message = message.into();
        if self.messages.contains(&message) {
            return;
        }
        if self.messages.len() < KEPT {
            self.messages.push(message);
        } else {
            self.dropped += 1;
        }
    }

    /// The messages; a last one counts those beyond the first hundred.
    #[must_use]
    pub fn into_messages(mut self) -> Vec<String> {
        if self.dropped > 0 {
            self.messages
                .push(format!("{} further warnings", self.dropped));
        }
        self.messages
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_messages_once_and_a_hundred_at_most() {
        let mut warnings = Warnings::default();
        for i in 0..130 {
            warnings.push(format!("w{}", i / 2 * 2));
            warnings.push("same");
        }
        let messages = warnings.clone().into_messages();
        assert_eq!(messages.len(), 66);
        for i in 0..200 {
            warnings.push(format!("x{i}"));
        }
        let messages = warnings.into_messages();
        assert_eq!(messages.len(), 101);
        assert_eq!(messages[100], "166 further warnings");
    }
}

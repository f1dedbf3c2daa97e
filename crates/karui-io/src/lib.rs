//! Readers and writers for Karui.

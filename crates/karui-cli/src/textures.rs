//! The images of a scene, decoded.

use crate::console::Console;
use crate::input::Input;
use karui::render::Picture;

/// All images of a model that can be decoded, by their index; warns of the others.
pub fn decode(input: &Input, console: &Console) -> Vec<Option<Picture>> {
    let (pictures, warnings) = karui_io::pictures_of(&input.scene);
    for warning in warnings {
        console.warn(&format!("{}: {warning}", input.path.display()));
    }
    pictures
}

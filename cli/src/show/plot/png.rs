//! A figure as PNG: its SVG, rasterised. Letters are DejaVu Sans, which comes with the tool, so the picture is the same on a
//! machine without fonts.

use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

use crate::failure::Failure;

/// Pixels a unit of the SVG [1]: for slides and dense screens.
const SCALE: f32 = 2.0;

/// The drawing of [`svg`](super::svg()) as PNG.
pub(super) fn png(svg: &str) -> Result<Vec<u8>, Failure> {
    static FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| {
        let mut fonts = fontdb::Database::new();
        fonts.load_font_data(dejavu::sans::regular().to_vec());
        fonts.load_font_data(dejavu::sans::bold().to_vec());
        fonts.set_sans_serif_family("DejaVu Sans");
        Arc::new(fonts)
    });
    let options =
        Options { fontdb: FONTS.clone(), font_family: "DejaVu Sans".to_owned(), ..Options::default() };
    let tree = Tree::from_str(svg, &options).map_err(unpainted)?;
    let size = tree.size();
    let [width, height] = [size.width(), size.height()].map(|side| (side * SCALE).ceil() as u32);
    let mut pixels = Pixmap::new(width, height).ok_or_else(|| unpainted("it has no room"))?;
    resvg::render(&tree, Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    pixels.encode_png().map_err(unpainted)
}

fn unpainted(cause: impl std::fmt::Display) -> Failure {
    Failure::Internal(format!("the plot cannot be painted: {cause}"))
}

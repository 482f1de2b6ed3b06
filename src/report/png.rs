//! SVG -> PNG with the bundled font, so that a picture looks the same everywhere and its text never goes missing.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::Database;
use resvg::usvg::{Options, Tree};
use std::sync::{Arc, LazyLock};

/// DejaVu Sans with the letters, Greek, signs and arrows that a figure may hold; see `font/LICENSE`.
static FONT: &[u8] = include_bytes!("font/DejaVuSans-subset.ttf");
/// Its family name.
const FAMILY: &str = "DejaVu Sans";
/// Pixels of the picture per pixel of the drawing: sharp in print and on dense screens.
const DENSITY: f32 = 2.0;

static FONTS: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let mut fonts = Database::new();
    fonts.load_font_data(FONT.to_vec());
    fonts.set_sans_serif_family(FAMILY);
    Arc::new(fonts)
});

/// `svg` as a PNG, twice as large in each direction.
///
/// Errors: what is wrong with the SVG, or that it has no size.
pub fn render(svg: &str) -> Result<Vec<u8>, String> {
    let options = Options { font_family: FAMILY.to_string(), fontdb: Arc::clone(&FONTS), ..Options::default() };
    let tree = Tree::from_str(svg, &options).map_err(|error| error.to_string())?;
    let size = tree.size().to_int_size().scale_by(DENSITY).ok_or("the drawing has no size")?;
    let mut picture = Pixmap::new(size.width(), size.height()).ok_or("the drawing is too large")?;
    resvg::render(&tree, Transform::from_scale(DENSITY, DENSITY), &mut picture.as_mut());
    // A drawing has a white ground, so that nothing of it is transparent.
    let rgb: Vec<u8> = picture.data().chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    encode(&rgb, (picture.width(), picture.height())).map_err(|error| error.to_string())
}

/// Red, green and blue of each pixel as a PNG. Fast compression: the best takes most of the time of a picture and makes it a
/// third smaller.
fn encode(rgb: &[u8], (width, height): (u32, u32)) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgb)?;
    writer.finish()?;
    Ok(bytes)
}

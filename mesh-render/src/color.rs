//! Colours of materials and of heat maps.

/// Red, green, blue, each from 0 to 1.
pub type Rgb = [f32; 3];

/// Colour of the source.
pub const SOURCE: Rgb = [0.64, 0.73, 0.86];
/// Colour of the target.
pub const TARGET: Rgb = [0.88, 0.80, 0.68];
/// Colour of the initial deformation.
pub const INITIAL: Rgb = [0.80, 0.76, 0.86];
/// Colour of the result.
pub const RESULT: Rgb = [0.62, 0.82, 0.74];
/// Colour of landmarks.
pub const LANDMARK: Rgb = [0.85, 0.16, 0.22];

/// Stops of the heat map, evenly spaced, rising in lightness so that the order survives a grey print.
pub const HEAT_STOPS: [Rgb; 6] = [
    [0.16, 0.11, 0.36],
    [0.18, 0.30, 0.58],
    [0.11, 0.51, 0.61],
    [0.25, 0.70, 0.48],
    [0.66, 0.83, 0.31],
    [0.99, 0.91, 0.36],
];

/// Colour of a value between 0 (dark) and 1 (bright); values outside are clamped, NaN counts as 0.
pub fn heat(value: f64) -> Rgb {
    let at = value.clamp(0.0, 1.0).max(0.0) as f32 * (HEAT_STOPS.len() - 1) as f32;
    let low = (at as usize).min(HEAT_STOPS.len() - 2);
    mix(HEAT_STOPS[low], HEAT_STOPS[low + 1], at - low as f32)
}

/// `(1 − t) a + t b`
pub fn mix(a: Rgb, b: Rgb, t: f32) -> Rgb {
    [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * t)
}

/// `#rrggbb`
pub fn hex(color: Rgb) -> String {
    let [r, g, b] = color.map(byte);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The byte nearest to a channel.
pub fn byte(channel: f32) -> u8 {
    (channel.clamp(0.0, 1.0) * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lightness([r, g, b]: Rgb) -> f32 {
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    #[test]
    fn heat_rises_in_lightness_and_clamps() {
        let steps: Vec<f32> = (0..=100)
            .map(|k| lightness(heat(f64::from(k) / 100.0)))
            .collect();
        assert!(steps.windows(2).all(|w| w[0] < w[1]));
        assert_eq!(heat(-3.0), HEAT_STOPS[0]);
        assert_eq!(heat(7.0), HEAT_STOPS[5]);
        assert_eq!(heat(f64::NAN), HEAT_STOPS[0]);
    }

    #[test]
    fn hex_rounds() {
        assert_eq!(hex([0.0, 0.5, 1.0]), "#0080ff");
    }
}

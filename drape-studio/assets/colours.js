// Colours of landmarks: far apart from one to the next, and dark enough for white digits.

// Contrast that small text needs (WCAG 2.2, 1.4.3).
const LEGIBLE = 4.5;
const GOLDEN_ANGLE = 137.508;
const SATURATION = 0.62;

const rgb = (hue, lightness) => {
  const strength = SATURATION * Math.min(lightness, 1 - lightness);
  return [0, 8, 4].map((n) => {
    const k = (n + hue / 30) % 12;
    return lightness - strength * Math.max(-1, Math.min(k - 3, 9 - k, 1));
  });
};

// Relative luminance of a colour, 0 for black and 1 for white.
const luminance = (colour) => {
  const linear = colour.map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
  return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
};

export const contrastWithWhite = (colour) => 1.05 / (luminance(colour) + 0.05);

// Red, green and blue of the landmark with a number of its own, each from 0 to 1.
export const markRgb = (id) => {
  const hue = (id * GOLDEN_ANGLE) % 360;
  let lightness = 0.42;
  while (contrastWithWhite(rgb(hue, lightness)) < LEGIBLE) lightness -= 0.01;
  return rgb(hue, lightness);
};

export const markColour = (id) => `rgb(${markRgb(id).map((c) => Math.floor(255 * c)).join(" ")})`;

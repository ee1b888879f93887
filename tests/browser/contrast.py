"""Whether a text can be read on its ground: WCAG 2.1, 1.4.3."""


def rgb(text):
    """Of a colour as a browser computes it: "rgb(1, 2, 3)"."""
    return [float(part) for part in text[text.index("(") + 1:-1].split(",")[:3]]


def contrast(one, other):
    def luminance(colour):
        channels = [c / 255 for c in colour]
        red, green, blue = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
        return 0.2126 * red + 0.7152 * green + 0.0722 * blue
    high, low = sorted((luminance(one), luminance(other)), reverse=True)
    return (high + 0.05) / (low + 0.05)

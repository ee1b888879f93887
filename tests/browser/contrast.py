"""Whether a text can be read on its ground, and a mark be seen: WCAG 2.2, 1.4.3 and 1.4.11; whether a finger meets a control: 2.5.8."""

TEXT = 4.5
MARK = 3.0
TARGET_PX = 24

# In a page: each element with a text of its own, as [name, colour, colour of its ground]; what is hidden is left out.
TEXTS = """(within => [...document.querySelectorAll(within)].filter(e => e.checkVisibility({visibilityProperty: true})
    && !e.closest('.hidden, .uplot') && ([...e.childNodes].some(n => n.nodeType === 3 && n.textContent.trim()) || e.value)).map(e => {
  let back = e;
  while (back && getComputedStyle(back).backgroundColor === 'rgba(0, 0, 0, 0)') back = back.parentElement;
  return [`${e.tagName}#${e.id}.${e.className}`, getComputedStyle(e).color, back ? getComputedStyle(back).backgroundColor : 'rgb(255, 255, 255)'];
}))"""
# Each control that a finger may mean, as [name, width, height]: of a radio or a field the label around it is one with it.
TARGETS = """(within => [...document.querySelectorAll(within)].filter(e => e.checkVisibility({visibilityProperty: true})).map(e => {
  const box = e.getBoundingClientRect();
  return [`${e.tagName}#${e.id}.${e.className} ${e.textContent.trim().slice(0, 20)}`, box.width, box.height];
}))"""
CONTROLS = "button, input, select, summary, a"


def colours(page, *names):
    """Custom properties of the page, as pixels: what its canvases are drawn with."""
    return {name: page.value(f"""(() => {{
      const canvas = document.createElement('canvas').getContext('2d');
      canvas.fillStyle = getComputedStyle(document.documentElement).getPropertyValue('{name}');
      canvas.fillRect(0, 0, 1, 1);
      return [...canvas.getImageData(0, 0, 1, 1).data].slice(0, 3);
    }})()""") for name in names}


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

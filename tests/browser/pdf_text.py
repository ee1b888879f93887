"""Text of the pages of a PDF as Chromium writes it: no pdftotext is needed."""

import re
import zlib

HEX = re.compile(rb"<([0-9A-Fa-f]+)>")


def stream_of(body):
    head, _, rest = body.partition(b"stream\n")
    data = rest[:rest.rindex(b"endstream")]
    return zlib.decompressobj().decompress(data) if b"/FlateDecode" in head else data


def letters_of(cmap):
    """Glyph → text, of a font's ToUnicode."""
    def text(code):
        return bytes.fromhex(code.decode()).decode("utf-16-be")
    letters = {}
    for block in re.findall(rb"beginbfchar(.*?)endbfchar", cmap, re.S):
        codes = HEX.findall(block)
        letters.update((int(glyph, 16), text(code)) for glyph, code in zip(codes[::2], codes[1::2]))
    for block in re.findall(rb"beginbfrange(.*?)endbfrange", cmap, re.S):
        codes = HEX.findall(block)
        for first, last, code in zip(codes[::3], codes[1::3], codes[2::3]):
            for k in range(int(first, 16), int(last, 16) + 1):
                letters[k] = chr(int(code, 16) + k - int(first, 16))
    return letters


TOKENS = re.compile(rb"/(F\d+) [\d.]+ Tf|<([0-9A-Fa-f]+)> Tj|/(X\d+) Do")


def pages(pdf):
    """The text of each page, in the order in which it is drawn."""
    objects = {int(number): body for number, body in re.findall(rb"(?:^|\n)(\d+) 0 obj\n(.*?)\nendobj", pdf, re.S)}

    def of(body, name):
        return objects[int(re.search(rb"/%s (\d+) 0 R" % name, body)[1])]

    def text_of(content, resources):
        letters = {}
        for font, glyphs, form in TOKENS.findall(content):
            if font:
                letters = letters_of(stream_of(of(of(resources, font), b"ToUnicode")))
            elif form:
                inner = of(resources, form)
                if b"/Subtype /Form" in inner:
                    yield from text_of(stream_of(inner), inner.partition(b"stream\n")[0])
            else:
                yield from (letters.get(int(glyphs[at:at + 4], 16), "") for at in range(0, len(glyphs), 4))
    return ["".join(text_of(stream_of(of(body, b"Contents")), body)) for body in objects.values() if re.search(rb"/Type /Page\b(?!s)", body)]

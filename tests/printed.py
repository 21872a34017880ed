"""Reports in a real browser: where a click on the contents leads, and how many pictures a PDF has."""

import base64
import re
import struct
import zlib

PICTURE = re.compile(r'src="data:image/svg\+xml;base64,[^"]*"')


def _chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def _png(number):
    """A picture of 4 by 4 pixels that no other number has."""
    rows = b"".join(b"\0" + bytes((number % 251, number // 251, 40 * i)) * 4 for i in range(4))
    head = struct.pack(">IIBBBBB", 4, 4, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", head) + _chunk(b"IDAT", zlib.compress(rows)) + _chunk(b"IEND", b"")


def pictures_and_printed(browser, path, folder):
    """The number of pictures of a page, and of those in its PDF.

    A PDF has vector pictures as strokes, which cannot be counted; so each picture is first exchanged for a small one of pixels.
    """
    count = 0

    def exchanged(_):
        nonlocal count
        count += 1
        return f'src="data:image/png;base64,{base64.b64encode(_png(count)).decode()}"'

    other = folder / f"pixels-{path.stem}.html"
    other.write_text(PICTURE.sub(exchanged, path.read_text(encoding="utf-8")), encoding="utf-8")
    page = browser.new_page()
    page.goto(other.as_uri())
    printed = page.pdf(format="A4").count(b"/Subtype /Image")
    page.close()
    return count, printed


def entries_that_lead_astray(browser, path, width, every=1):
    """The entries of the contents after whose click the heading is not at the top, with its distance [pixel]; and how many there are.

    Of many entries each n-th is clicked, and the last one.
    """
    page = browser.new_page(viewport={"width": width, "height": 800})
    page.goto(path.as_uri())
    page.evaluate("document.querySelectorAll('nav details').forEach(each => { each.open = true })")
    astray, links = [], page.query_selector_all("nav a[href^='#']")
    for link in dict.fromkeys([*links[::every], *links[-1:]]):
        page.evaluate("scrollTo(0, 0)")
        link.click()
        target = link.get_attribute("href")[1:]
        page.wait_for_timeout(20)
        top, end = page.evaluate(
            "id => [document.getElementById(id).getBoundingClientRect().top,"
            " innerHeight + scrollY >= document.documentElement.scrollHeight - 2]",
            target,
        )
        if abs(top) > 50 and not end:
            astray.append((target, round(top)))
    page.close()
    return astray, len(links)

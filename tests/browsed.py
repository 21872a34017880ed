"""A page of the explorer in a real browser, and what went wrong on it."""

import contextlib
from urllib.parse import urlsplit

from explorers import PATIENCE
from stickslip.basics.typed_numbers import in_unit

WAIT = PATIENCE * 1000  # [ms]
#: Kinds whose kernels the rest of the tests need as well; others would each take a compiler's ten seconds.
QUICK = "law=coulomb&also="


class Page:
    """A page of the explorer, and what went wrong on it."""

    def __init__(self, browser, explorer, width=1200, height=900, **options):
        self.context = browser.new_context(**{"viewport": {"width": width, "height": height}, "reduced_motion": "reduce", **options})
        self.explorer, self.errors, self.outside, self.loaded = explorer, [], [], False
        self.page = self.context.new_page()
        self.page.on("request", self._asked)
        self.page.set_default_timeout(WAIT)
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("console", lambda said: self.errors.append(said.text) if said.type == "error" else None)

    def _asked(self, request):
        """What is asked of another host than ours, which the browser cannot reach."""
        url = urlsplit(request.url)
        if url.netloc and url.netloc != urlsplit(self.explorer.address).netloc:
            self.outside.append(request.url)

    def anew(self, width=1200, height=900, color_scheme="light", reduced_motion="reduce"):
        """The page for another test: it is loaded again by the process that it has, which takes half the time of a new one."""
        for other in self.context.pages:
            if other != self.page:
                other.close()
        self.page.set_viewport_size({"width": width, "height": height})
        self.page.emulate_media(color_scheme=color_scheme, reduced_motion=reduced_motion)
        self.errors.clear()
        self.outside.clear()
        self.loaded = False
        return self

    def open(self, hash=QUICK):
        if self.loaded or self.page.url == "about:blank":
            self.page.goto(f"{self.explorer.address}#{hash}")
        else:
            with self.page.expect_navigation():
                self.page.evaluate(
                    "hash => { localStorage.clear(); history.replaceState(null, '', location.pathname + hash); location.reload(); }",
                    f"#{hash}",
                )
        self.loaded = True
        self.settled()
        return self

    def settled(self, after=None):
        """Wait until the curves of a slider that rests are drawn, later ones than `after`."""
        old = -1 if after is None else after
        drawn = "old => { const [n, how] = (document.documentElement.dataset.drawn ?? '-1').split(' '); return n > old && how === 'fine'; }"
        self.page.wait_for_function(drawn, arg=old, polling=50)

    def drawn(self):
        """The number of the last answer that was drawn."""
        return int((self.attribute("html", "data-drawn") or "-1").split()[0])

    def attribute(self, selector, name):
        return self.page.locator(selector).get_attribute(name)

    @contextlib.contextmanager
    def change(self):
        """What is done within changes the page; afterwards it rests."""
        before = self.drawn()
        yield
        self.settled(before)

    def merit(self, name):
        return self.page.locator(f"[data-quantity={name}]").inner_text()

    def velocity(self):
        """The mean velocity that is shown [m/s]."""
        text = self.merit("mean_velocity")
        number, unit = text.split()
        return in_unit(f"{number.replace('−', '-')} {unit}", "m/s")

    def slide(self, name, value):
        """Put a slider somewhere, as a hand does."""
        self.page.locator(f"input[name={name}]").evaluate(
            "(el, value) => { el.value = value; el.dispatchEvent(new Event('input', {bubbles: true})); }", value
        )

    def said(self):
        return self.page.locator("#said").inner_text()

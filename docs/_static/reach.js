// Whatever scrolls sideways can be reached with the keyboard; captions of contents say which heading they are.
addEventListener("DOMContentLoaded", () => {
  for (const box of document.querySelectorAll("pre, div.math, div.table-wrapper, div.highlight"))
    if (box.scrollWidth > box.clientWidth) box.tabIndex = 0;
  for (const caption of document.querySelectorAll("p.caption[role=heading]:not([aria-level])")) caption.ariaLevel = "2";
});

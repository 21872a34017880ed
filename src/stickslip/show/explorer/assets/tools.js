// What the two pages have in common: the line of words, the state of the link, files and links to take home, light and dark.
export const $ = (id) => document.getElementById(id);

export function say(sentence, kind = "bad") {
  if ($("said").textContent !== sentence) $("said").textContent = sentence;
  $("said").dataset.state = kind;
}

export function connection(how) {
  $("link").dataset.state = how;
  $("link").textContent = how === "open" ? "connected" : "connection lost, trying again … (started anew, stickslip prints a new address)";
}

// What a link has that the page leaves out, told until another one is opened; `takes` says of a name and its text whether it is taken.
export function leftOut(takes) {
  const names = [...new URLSearchParams(location.hash.slice(1))].filter(([name, text]) => !takes(name, text)).map(([name]) => name.slice(0, 40));
  const more = names.length > 6 ? ` and ${names.length - 6} more` : "";
  const message = `The link says ${names.slice(0, 6).join(", ")}${more}: no such number is here, or not with such a value. What is shown is without it.`;
  $("left-out").textContent = names.length ? message : "";
  $("left-out").hidden = !names.length;
}

// Files, fetched from where `address` says for a name.
export function exports(address) {
  $("export").addEventListener("change", async (event) => {
    const name = event.target.value;
    event.target.value = "";
    if (!name) return;
    say(`making ${name} …`, "busy");
    try {
      const reply = await fetch(address(name));
      if (!reply.ok) throw new Error(await reply.text());
      const made = URL.createObjectURL(await reply.blob());
      Object.assign(document.createElement("a"), { href: made, download: name }).click();
      setTimeout(() => URL.revokeObjectURL(made), 10_000);
      say("");
    } catch (error) {
      say(`${name}: ${error.message}`);
    }
  });
}

// A button that copies a text; `hash` is what the address has of the numbers.
export function copies(button, hash, text, word) {
  button.addEventListener("click", async () => {
    history.replaceState(null, "", hash());
    try {
      await navigator.clipboard.writeText(text());
      button.textContent = "Copied";
    } catch {
      button.textContent = "Copy it from the address bar";
    }
    setTimeout(() => { button.textContent = word; }, 1800);
  });
}

// Light and dark, now and whenever it is chosen; then `restyle` draws anew.
export function themed(restyle) {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  function theme() {
    const chosen = $("theme").value;
    document.documentElement.dataset.theme = chosen === "auto" ? (dark.matches ? "dark" : "light") : chosen;
    restyle();
  }
  try { $("theme").value = localStorage.getItem("theme") ?? "auto"; } catch { /* storage may be forbidden */ }
  $("theme").addEventListener("change", () => { try { localStorage.setItem("theme", $("theme").value); } catch { /* as above */ } theme(); });
  dark.addEventListener("change", theme);
  theme();
}

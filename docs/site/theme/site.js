// Equations: blocks of TeX become pictures of it. Search: all sections that hold every word, headings first.
for (const code of document.querySelectorAll("code.language-math")) {
  const equation = document.createElement("div");
  equation.className = "equation";
  katex.render(code.textContent, equation, { displayMode: true, throwOnError: false });
  code.parentNode.replaceWith(equation);
}

const most = 20;
const [field, found, menu] = ["search", "found", "menu"].map((id) => document.getElementById(id));

function result([address, title, heading, text], words) {
  const at = Math.max(0, text.toLowerCase().indexOf(words[0]) - 30);
  const [item, link, about] = ["li", "a", "small"].map((name) => document.createElement(name));
  link.href = TOP + address;
  link.textContent = heading === title ? title : `${title}: ${heading}`;
  for (const piece of text.slice(at, at + 110).split(new RegExp(`(${words.map((w) => w.replace(/[^\p{L}\p{N}]/gu, "\\$&")).join("|")})`, "iu"))) {
    const part = document.createElement(words.includes(piece.toLowerCase()) ? "mark" : "span");
    part.textContent = piece;
    about.append(part);
  }
  link.append(about);
  item.append(link);
  return item;
}

function search() {
  const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
  const score = ([, title, heading, text]) => {
    const [head, body] = [`${title} ${heading}`.toLowerCase(), text.toLowerCase()];
    if (!words.every((word) => head.includes(word) || body.includes(word))) return 0;
    return 1 + 10 * words.filter((word) => heading.toLowerCase().includes(word)).length;
  };
  const hits = words.length ? SECTIONS.map((s) => [score(s), s]).filter(([points]) => points > 0) : [];
  hits.sort((a, b) => b[0] - a[0]);
  found.replaceChildren(...hits.slice(0, most).map(([, section]) => result(section, words)));
  if (words.length && !hits.length) found.textContent = "Nothing found.";
  found.hidden = !words.length;
  menu.hidden = words.length > 0;
}
field.addEventListener("input", search);

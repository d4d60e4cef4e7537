// Formulas in the excerpts of search results: short ones as they are typed, others as an ellipsis.
document.addEventListener("DOMContentLoaded", () => {
  if (typeof Search === "undefined") return;
  const text = Search.htmlToText;
  Search.htmlToText = (html, anchor) => {
    const page = new DOMParser().parseFromString(html, "text/html");
    for (const formula of page.querySelectorAll(".math")) {
      const tex = formula.textContent.trim().slice(2, -2);
      formula.textContent = /[\\{}]/.test(tex) ? "…" : tex;
    }
    return text(page.documentElement.outerHTML, anchor);
  };
});

// A formula in a line that is longer than the line scrolls; then it can be reached by the keyboard.
window.addEventListener("load", async () => {
  await window.MathJax?.startup?.promise;
  for (const formula of document.querySelectorAll("span.math mjx-container")) {
    const line = formula.closest("p, li, dd, td, th, h1, h2, h3, h4");
    if (line === null || formula.getBoundingClientRect().width <= line.clientWidth) continue;
    formula.classList.add("wide");
    formula.tabIndex = 0;
  }
});

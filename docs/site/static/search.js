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

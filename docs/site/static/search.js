// The search box: pages that have all words or most of them, by how rare the words are and where they stand, guides first.
// Accents do not count, and a page is found by words of searchWords, too, which users say and its text does not.
document.addEventListener("DOMContentLoaded", () => {
  if (typeof Search === "undefined") return;

  const enough = 0.6; // of the weight of all words that any page has
  const weights = { title: 3, heading: 2, text: 1, part: 0.5 };
  const background = /^(changelog|references|architecture|contributing|releasing|security|support|benchmarks|verification|names)$/;
  const kinds = [[background, -0.9], [/^(reference|commands)\//, 0], [/^(gallery|stories)\//, 0.3], [/./, 0.5]];
  const stemmer = new Stemmer();
  const folded = (word) => stemmer.stemWord(word.toLowerCase().normalize("NFD").replace(/\p{M}/gu, ""));
  const listed = (files) => (Array.isArray(files) ? files : [files]);
  let tables = null;

  // What Sphinx says of a search without results speaks of categories, which this site does not have.
  new MutationObserver(() => {
    const said = document.querySelector("#search-results .search-summary");
    if (said !== null && /did not match/.test(said.textContent) && !/other words/.test(said.textContent)) {
      said.textContent = "No page has these words. Try other words, or fewer; the glossary has those of other fields.";
    }
  }).observe(document.getElementById("search-results"), { childList: true, subtree: true, characterData: true });

  /** From each folded word to its pages: in headings and words of searchWords, and in text. */
  function words() {
    const index = Search._index;
    const table = (terms) => {
      const found = new Map();
      for (const [term, files] of Object.entries(terms)) {
        const key = folded(term);
        found.set(key, [...(found.get(key) ?? []), ...listed(files)]);
      }
      return found;
    };
    const headings = table(index.titleterms);
    const titles = new Map();
    const add = (to, word, file) => to.set(word, [...(to.get(word) ?? []), file]);
    index.docnames.forEach((name, file) => {
      for (const word of splitQuery(index.titles[file])) add(titles, folded(word), file);
      for (const word of splitQuery(window.searchWords?.[name] ?? "")) add(headings, folded(word), file);
    });
    return [[titles, weights.title], [headings, weights.heading], [table(index.terms), weights.text]];
  }

  /** How much a word weighs on each page that has it; a part of a longer word counts where no page has the word. */
  function pagesWith(word) {
    const found = new Map();
    const note = (files, weight) => files.forEach((file) => found.set(file, Math.max(weight, found.get(file) ?? 0)));
    tables.forEach(([table, weight]) => note(table.get(word) ?? [], weight));
    if (found.size === 0 && word.length > 2) {
      tables.forEach(([table]) => table.forEach((files, key) => key.includes(word) && note(files, weights.part)));
    }
    return found;
  }

  Search.performTermsSearch = (searchTerms, excludedTerms) => {
    tables ??= words();
    const { docnames, titles, filenames } = Search._index;
    const asked = [...searchTerms].map((word) => pagesWith(folded(word))).filter((pages) => pages.size > 0);
    const refused = new Set([...excludedTerms].flatMap((word) => [...pagesWith(folded(word)).keys()]));
    const rarity = asked.map((pages) => Math.log(1 + docnames.length / pages.size));
    const whole = rarity.reduce((sum, one) => sum + one, 0);
    return docnames.flatMap((name, file) => {
      const has = (one) => asked[one].has(file);
      const matched = rarity.reduce((sum, one, i) => sum + (has(i) ? one : 0), 0) / whole;
      if (!(matched >= enough) || refused.has(file)) return [];
      const weight = rarity.reduce((sum, one, i) => sum + one * (asked[i].get(file) ?? 0), 0) / whole;
      const score = 10 * (matched * weight + kinds.find(([pattern]) => pattern.test(name))[1]);
      return [[name, titles[file], "", null, score, filenames[file], SearchResultKind.text]];
    });
  };
});

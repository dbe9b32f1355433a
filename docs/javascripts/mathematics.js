// Sets every formula of a page; pymdownx.arithmatex has marked them. Where one is wider than its place, it can be
// scrolled by keyboard too.
function reachFormulas() {
  document.querySelectorAll("div.arithmatex").forEach((formula) => {
    if (formula.scrollWidth > formula.clientWidth) formula.tabIndex = 0;
    else formula.removeAttribute("tabindex");
  });
}
window.addEventListener("resize", reachFormulas);
document$.subscribe(({ body }) => {
  renderMathInElement(body, {
    delimiters: [
      { left: "\\[", right: "\\]", display: true },
      { left: "\\(", right: "\\)", display: false },
    ],
    throwOnError: false,
  });
  reachFormulas();
});

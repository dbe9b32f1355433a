// Names what the theme leaves without a name for screen readers, and lets wide tables scroll by keyboard.
document.querySelector("[data-md-component=search]")?.setAttribute("aria-label", "Search");
document$.subscribe(() => {
  document.querySelectorAll("nav.md-code__nav").forEach((nav, index) => {
    nav.setAttribute("aria-label", `Code block ${index + 1}`);
  });
  document.querySelectorAll(".md-typeset__scrollwrap").forEach((table) => {
    table.tabIndex = 0;
  });
});

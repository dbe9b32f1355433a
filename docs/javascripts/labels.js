// Names what the theme leaves without a name for screen readers.
document.querySelector("[data-md-component=search]")?.setAttribute("aria-label", "Search");
document$.subscribe(() => {
  document.querySelectorAll("nav.md-code__nav").forEach((nav, index) => {
    nav.setAttribute("aria-label", `Code block ${index + 1}`);
  });
});

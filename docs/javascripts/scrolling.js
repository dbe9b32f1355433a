// Lets formulas and code that are wider than their place be scrolled by keyboard; formulas are set before.
function reach() {
  document.querySelectorAll("div.arithmatex, pre > code").forEach((part) => {
    if (part.scrollWidth > part.clientWidth) part.tabIndex = 0;
  });
}
document$.subscribe(reach);
window.addEventListener("resize", reach);
document.addEventListener("toggle", reach, true);  // What was folded has no width.

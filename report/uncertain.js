// A number with its errors as text. The only place of the pages that formats one; io/uncertain gives the same in C++.
"use strict";

const Uncertain = (() => {
  const known = error => error != null && !Number.isNaN(error);
  const finite = error => (Number.isFinite(error) ? error : 0);
  // Decimals that show so many significant digits of a positive number, once it is rounded to them.
  const decimalsOf = (number, digits) => digits - 1 - Number(number.toExponential(digits - 1).split("e")[1]);
  // An error that would round to zero has one digit, or is a bound beyond the most decimals.
  function errorText(error, decimals, most) {
    if (error === Infinity) return "∞";
    const text = error.toFixed(decimals);
    if (!(error > 0) || /[1-9]/.test(text)) return text;
    const own = decimalsOf(error, 1);
    return own <= most ? error.toFixed(own) : `<${(10 ** -most).toFixed(most)}`;
  }

  /// \param errors  {standard_error, systematic_uncertainty}, both optional, or undefined.
  /// \param plain  decimals of a value without errors; with errors at most two more, to show two digits of the larger one.
  /// \return value, with "?" behind it if not significant, errors as ["± 0.0027", "± 0.0019"] (statistical, systematic; empty: none), significant.
  function parts(value, errors, plain) {
    if (!Number.isFinite(value)) return {value: "–", errors: [], significant: true};
    const random = errors?.standard_error, systematic = errors?.systematic_uncertainty;
    const largest = Math.max(finite(random), finite(systematic));
    const most = plain + 2;
    const decimals = largest > 0 ? Math.min(Math.max(decimalsOf(largest, 2), 0), most) : plain;
    const significant = !(Math.hypot(known(random) ? random : 0, known(systematic) ? systematic : 0) > Math.abs(value));
    const said = [];
    if (known(random)) said.push(`± ${errorText(random, decimals, most)}`);
    if (known(systematic)) said.push(`± ${errorText(systematic, decimals, most)}`, ...(known(random) ? [] : ["(syst.)"]));
    return {value: value.toFixed(decimals) + (significant ? "" : "?"), errors: said, significant};
  }

  /// Decimals of a number whose uncertainty stands beside it: two significant digits of that, at most two more than plain.
  const decimalsFor = (uncertainty, plain) =>
    (known(uncertainty) && Number.isFinite(uncertainty) && uncertainty !== 0 ? Math.min(Math.max(decimalsOf(Math.abs(uncertainty), 2), 0), plain + 2) : plain);

  /// On one line: "0.0470 ± 0.0027 ± 0.0019".
  function text(value, errors, plain) {
    const own = parts(value, errors, plain);
    return [own.value, ...own.errors].join(" ");
  }

  /// Children of a cell: the number and its marks, and the errors below it, on one line or on two where there is little room.
  function lines(value, errors, plain, marks = "") {
    const own = parts(value, errors, plain);
    if (own.errors.length === 0) return [own.value + marks];
    const below = document.createElement("span");
    below.className = "errors";
    own.errors.forEach((error, k) => {
      const one = document.createElement("span");
      one.textContent = error;
      below.append(...(k > 0 ? [" "] : []), one);
    });
    return [`${own.value}${marks} `, below];
  }

  /// What the errors and marks of these numbers mean; empty: they have none. \param numbers  [value, errors] each.
  function legend(numbers) {
    const has = key => numbers.some(([value, errors]) => Number.isFinite(value) && known(errors?.[key]));
    const said = [];
    if (has("standard_error") || has("systematic_uncertainty")) said.push("± standard error" + (has("systematic_uncertainty") ? " ± systematic part (calibration, corrections)" : ""));
    if (numbers.some(([value, errors]) => !parts(value, errors, 0).significant)) said.push("? not significant, its errors together exceed it");
    return said.join(" · ");
  }

  return {parts, text, lines, legend, decimalsFor};
})();

"""A number with its errors as people are shown it, by Python's own decimals: what io/uncertain and report/uncertain.js give."""

import decimal
import math


def parts(value, standard_error=None, systematic=None, decimals=4):
    """(value, standard error, systematic part) as texts; None for an error that is unknown."""
    errors = [None if error is None or math.isnan(error) else float(error) for error in (standard_error, systematic)]
    if value is None or not math.isfinite(value):
        return "–", None, None
    largest = max([error for error in errors if error is not None and math.isfinite(error)], default=0.0)
    most = decimals + 2

    def decimals_of(number, digits):
        # Rounded to so many digits first: 0.0996 has the exponent of 0.10.
        rounded = decimal.Context(prec=digits).create_decimal(decimal.Decimal(number))
        return digits - 1 - rounded.adjusted()

    shown = min(max(decimals_of(largest, 2), 0), most) if largest > 0 else decimals

    def error_text(error):
        if error is None:
            return None
        if math.isinf(error):
            return "∞"
        text = f"{error:.{shown}f}"
        if error == 0 or float(text) > 0:
            return text
        own = decimals_of(error, 1)
        return f"{error:.{own}f}" if own <= most else f"<{10.0 ** -most:.{most}f}"

    significant = math.hypot(*(error or 0.0 for error in errors)) <= abs(value)
    return f"{value:.{shown}f}" + ("" if significant else "?"), *map(error_text, errors)


def decimals_for(uncertainty, plain=4):
    """Decimals of a number beside its uncertainty: two significant digits of that."""
    if not uncertainty:
        return plain
    rounded = decimal.Context(prec=2).create_decimal(decimal.Decimal(uncertainty))
    return min(max(1 - rounded.adjusted(), 0), plain + 2)


def text(value, standard_error=None, systematic=None, decimals=4):
    own, random, constant = parts(value, standard_error, systematic, decimals)
    own += "" if random is None else f" ± {random}"
    return own + ("" if constant is None else f" ± {constant}" + (" (syst.)" if random is None else ""))


def of(record, name, decimals=4):
    """Text of a result of an open record (h5py)."""
    result = record[f"entry/results/{name}"]
    return text(float(result[()]), result.attrs.get("standard_error"), result.attrs.get("systematic_uncertainty"), decimals)

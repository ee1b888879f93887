"""The results of a test, the diagnostics among them, as they stand in a record and in JSON."""


def stored(record):
    """{name: data set} of an open record (h5py)."""
    group = record["entry/results"]
    return {name: one for name, one in group.items() if name != "diagnostics"} | dict(group["diagnostics"])


def told(results):
    """{name: value} of results as JSON."""
    return results | {name: detail["value"] for name, detail in results["diagnostics"].items()}

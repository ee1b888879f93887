"""Validation against the schemas of an OpenAPI document: the keywords that daemon/control/openapi.json uses, and no
others. A keyword that is not known here is an error, so that none is passed over in silence."""

KINDS = {"object": dict, "array": list, "string": str, "null": type(None)}
KNOWN = {"type", "properties", "required", "additionalProperties", "items", "enum", "description", "$ref", "anyOf",
         "minimum", "maximum", "exclusiveMinimum", "minLength", "maxLength"}


def is_a(value, kind):
    if kind == "boolean":
        return isinstance(value, bool)
    if kind == "integer":
        return isinstance(value, int) and not isinstance(value, bool)
    if kind == "number":
        return isinstance(value, (int, float)) and not isinstance(value, bool)
    return isinstance(value, KINDS[kind])


def complaints(value, schema, document, place="$"):
    """What is wrong with the value: a list of sentences, empty if nothing is."""
    unknown = set(schema) - KNOWN
    if unknown:
        return [f"{place}: the schema has unknown keywords {unknown}"]
    if "$ref" in schema:
        target = document
        for part in schema["$ref"].removeprefix("#/").split("/"):
            target = target[part]
        return complaints(value, target, document, place)
    if "anyOf" in schema:
        tried = [complaints(value, one, document, place) for one in schema["anyOf"]]
        return [] if any(not t for t in tried) else [f"{place}: none of {tried}"]
    found = []
    kinds = schema.get("type", [])
    kinds = [kinds] if isinstance(kinds, str) else kinds
    if kinds and not any(is_a(value, kind) for kind in kinds):
        return [f"{place}: {value!r} is no {kinds}"]
    if "enum" in schema and value not in schema["enum"]:
        found.append(f"{place}: {value!r} is none of {schema['enum']}")
    if isinstance(value, dict):
        found += [f"{place}: {key} is missing" for key in schema.get("required", []) if key not in value]
        for key, one in value.items():
            if key in schema.get("properties", {}):
                found += complaints(one, schema["properties"][key], document, f"{place}.{key}")
            elif schema.get("additionalProperties") is False:
                found.append(f"{place}: {key} is not described")
            elif "additionalProperties" in schema:
                found += complaints(one, schema["additionalProperties"], document, f"{place}.{key}")
    if isinstance(value, list) and "items" in schema:
        for at, one in enumerate(value):
            found += complaints(one, schema["items"], document, f"{place}[{at}]")
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        if value < schema.get("minimum", value) or value > schema.get("maximum", value):
            found.append(f"{place}: {value} is out of range")
        if "exclusiveMinimum" in schema and not value > schema["exclusiveMinimum"]:
            found.append(f"{place}: {value} is out of range")
    if isinstance(value, str) and not schema.get("minLength", 0) <= len(value) <= schema.get("maxLength", len(value)):
        found.append(f"{place}: {len(value)} characters")
    return found

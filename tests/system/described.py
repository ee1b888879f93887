"""Two OpenAPI descriptions compared: what a client that was written for the one misses at the other."""


class Document:
    def __init__(self, document):
        self.document = document

    def resolved(self, schema):
        while "$ref" in schema:
            place = self.document
            for step in schema["$ref"].removeprefix("#/").split("/"):
                place = place[step]
            schema = place
        return schema


def kinds(schema):
    named = schema.get("type", [])
    return {named} if isinstance(named, str) else set(named)


def within(inner, outer):
    """Is each kind of the one taken where the other is?"""
    return not outer or inner and all(kind in outer or kind == "integer" and "number" in outer for kind in inner)


# What bounds a value from below, and from above.
LOWER, UPPER = ("minimum", "exclusiveMinimum", "minLength", "minItems"), ("maximum", "exclusiveMaximum", "maxLength", "maxItems")


def worse_schema(then, now, documents, place, asked):
    """asked: of a request, where no less may be taken than then. Else of an answer, where no less may be told."""
    then, now = documents[0].resolved(then), documents[1].resolved(now)
    found = []
    if not (within(kinds(then), kinds(now)) if asked else within(kinds(now), kinds(then))):
        found.append(f"{place}: {sorted(kinds(now))}, was {sorted(kinds(then))}")
    if asked:
        found += [f"{place}: {bound} is {now[bound]}" for bound in LOWER if bound in now and not now[bound] <= then.get(bound, now[bound] - 1)]
        found += [f"{place}: {bound} is {now[bound]}" for bound in UPPER if bound in now and not now[bound] >= then.get(bound, now[bound] + 1)]
    if not asked or "enum" in now:
        found += [f"{place}: {word!r} is gone" for word in then.get("enum", []) if word not in now.get("enum", [])]
    needed, less = (now, then) if asked else (then, now)
    found += [f"{place}.{name} is {'required' if asked else 'not always there'}" for name in needed.get("required", []) if name not in less.get("required", [])]
    for name, one in then.get("properties", {}).items():
        if name not in now.get("properties", {}):
            found.append(f"{place}.{name} is gone")
        else:
            found += worse_schema(one, now["properties"][name], documents, f"{place}.{name}", asked)
    for key in ("items", "additionalProperties"):
        if isinstance(then.get(key), dict):
            found += worse_schema(then[key], now[key], documents, f"{place}[]", asked) if isinstance(now.get(key), dict) else [f"{place}: {key} are gone"]
    for key in ("anyOf", "oneOf"):
        if key in then:
            others = now.get(key, [now])
            tried = [[worse_schema(one, other, documents, place, asked) for other in others] for one in then[key]]
            found += [min(attempts, key=len)[0] for attempts in tried if all(attempts)]
    return found


def worse_content(then, now, documents, place, asked):
    found = []
    for kind, one in then.get("content", {}).items():
        if kind not in now.get("content", {}):
            found.append(f"{place}: {kind} is gone")
        elif "schema" in one:
            found += worse_schema(one["schema"], now["content"][kind].get("schema", {}), documents, place, asked)
    return found


def worse_request(then, now, documents, place):
    found = []

    def named(request):
        return {(one["in"], one["name"]): one for one in map(documents[then is not request].resolved, request.get("parameters", []))}

    before, after = named(then), named(now)
    found += [f"{place}: {name} is gone" for name in before if name not in after]
    found += [f"{place}: {name} is required" for name, one in after.items() if one.get("required") and not before.get(name, {}).get("required")]
    for name in before.keys() & after.keys():
        found += worse_schema(before[name].get("schema", {}), after[name].get("schema", {}), documents, f"{place} {name[1]}", True)
    if now.get("requestBody", {}).get("required") and not then.get("requestBody", {}).get("required"):
        found.append(f"{place}: a body is required")
    if "requestBody" in then:
        found += worse_content(then["requestBody"], now.get("requestBody", {}), documents, f"{place} body", True)
    for status, answer in then["responses"].items():
        if status not in now["responses"]:
            found.append(f"{place}: {status} is gone")
        else:
            found += worse_content(documents[0].resolved(answer), documents[1].resolved(now["responses"][status]), documents, f"{place} {status}", False)
    return found


def worse(then, now):
    """One line for each thing that a client of `then` misses."""
    documents = (Document(then), Document(now))
    found = []
    for path, requests in then["paths"].items():
        for method, request in requests.items():
            place = f"{method.upper()} {path}"
            if method not in now["paths"].get(path, {}):
                found.append(f"{place} is gone")
            else:
                found += worse_request(request, now["paths"][path][method], documents, place)
    return found

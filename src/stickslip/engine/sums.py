"""A traced expression as a sum: numbers of the case times what varies, such as 1, sin(omega t), or v."""

from __future__ import annotations

from stickslip.engine.symbols import STATE, Graph, Sym

#: Coefficients by what they stand in front of: the numbers of the nodes whose product it is; () is 1.
Terms = dict[tuple[int, ...], Sym]
_MOST = 256  # products of the terms of two sums; what has more is left as it is


def terms_of(node: Sym) -> Terms:
    """The terms of an expression, added up; what is neither a sum nor a product is one term, sines of a shifted phase are two.

    Examples
    --------
    >>> graph = Graph()
    >>> t, omega, a = graph.variable("t"), graph.case("omega"), graph.case("a")
    >>> sine = graph.call("sin", omega * t)
    >>> found = terms_of(a * (3.0 - 2.0 * sine))
    >>> found[()], found[sine.number,]
    (multiply(3.0, a), multiply(-2.0, a))
    """
    return _Sums(node.graph).of(node)


def difference(graph: Graph, a: Terms, b: Terms) -> Terms:
    """The terms of a - b."""
    zero = graph.constant(0.0)
    return _without_zeros({key: graph.subtract(a.get(key, zero), b.get(key, zero)) for key in {**a, **b}})


def rate_of(graph: Graph, key: tuple[int, ...], t: Sym) -> tuple[str, Sym] | None:
    """The name and the rate of a term sin(rate t) or cos(rate t); None of any other."""
    node = graph.nodes[key[0]] if len(key) == 1 else t
    if node.op not in ("sin", "cos"):
        return None
    arg = terms_of(node.args[0])
    return (node.op, arg[t.number,]) if set(arg) == {(t.number,)} else None


def _without_zeros(terms: Terms) -> Terms:
    return {key: c for key, c in terms.items() if not (c.op == "constant" and c.value == 0)}


class _Sums:
    def __init__(self, graph: Graph):
        self.graph, self.one, self.known = graph, graph.constant(1.0), dict[int, Terms]()

    def of(self, node: Sym) -> Terms:
        """The terms of a node, remembered."""
        if node.number not in self.known:
            self.known[node.number] = _without_zeros(self._terms(node))
        return self.known[node.number]

    def _terms(self, node: Sym) -> Terms:
        if node.level < STATE:
            return {(): node}
        match node.op:
            case "add" | "subtract":
                return self._added(node)
            case "multiply":
                return self._multiplied(node)
            case "sin" | "cos":
                return self._wave(node)
        return {(node.number,): self.one}

    def _added(self, node: Sym) -> Terms:
        first, second = map(self.of, node.args)
        minus = node.op == "subtract"
        if minus:
            return difference(self.graph, first, second)
        zero = self.graph.constant(0.0)
        return {key: self.graph.add(first.get(key, zero), second.get(key, zero)) for key in {**first, **second}}

    def _multiplied(self, node: Sym) -> Terms:
        first, second = map(self.of, node.args)
        if min(len(first), len(second)) > 1 and len(first) * len(second) > _MOST:
            return {(node.number,): self.one}
        product: Terms = {}
        for a, c in first.items():
            for b, d in second.items():
                key, more = tuple(sorted(a + b)), self.graph.multiply(c, d)
                product[key] = more if key not in product else self.graph.add(product[key], more)
        return product

    def _wave(self, node: Sym) -> Terms:
        """sin(r t + p) = cos(p) sin(r t) + sin(p) cos(r t), and so for the cosine: equal rates are equal terms whatever their phases."""
        graph, arg = self.graph, self.of(node.args[0])
        t = graph.variable("t")
        if not set(arg) <= {(), (t.number,)} or (t.number,) not in arg:
            return {(node.number,): self.one}
        turned = graph.multiply(arg[t.number,], t)
        sine, cosine = (graph.call(name, turned).number for name in ("sin", "cos"))
        if () not in arg:
            return {(sine if node.op == "sin" else cosine,): self.one}
        c, s = graph.call("cos", arg[()]), graph.call("sin", arg[()])
        return {(sine,): c, (cosine,): s} if node.op == "sin" else {(cosine,): c, (sine,): graph.multiply(graph.constant(-1.0), s)}

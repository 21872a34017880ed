"""``modelDescription.xml`` of an FMU, and ``buildDescription.xml`` of its sources (FMI 3.0.1)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

from stickslip.basics.fields import field_description
from stickslip.basics.units import unit_named
from stickslip.solvers.machine_in_c import FIXED, INPUT, MachineInC
from stickslip.solvers.moments import AHEAD

_UNITS = {"position": "m", "velocity": "m/s", "acceleration": "m/s^2", "force": "N"}
_TURNING = {"position": "rad", "velocity": "rad/s", "acceleration": "rad/s^2", "force": "N m"}
_WORDS = {
    "position": "position of {}", "velocity": "velocity of {}", "acceleration": "acceleration of {}", "force": "friction force on the body",
    "inner": "inner state of the law of {}", "control": "state of {}",
}  # fmt: skip
_BASE = ("m", "kg", "s", "A", "rad")


@dataclass(frozen=True)
class Described:
    """The description, and the names of what an importer sets and reads."""

    xml: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    parameters: tuple[str, ...]


def described(machine: Any, made: MachineInC, name: str, identifier: str, token: str, version: str) -> Described:
    """The description of a machine."""
    return _Description(machine, made).whole(name, identifier, token, version)


class _Description:
    def __init__(self, machine: Any, made: MachineInC):
        self.machine, self.made, self.units = machine, made, dict[str, Any]()
        self.own_units = _TURNING if getattr(machine, "rotary", False) else _UNITS
        self.variables = ElementTree.Element("ModelVariables")
        self.structure = ElementTree.Element("ModelStructure")
        self.inputs, self.outputs, self.parameters = list[str](), list[str](), list[str]()

    def whole(self, name: str, identifier: str, token: str, version: str) -> Described:
        made = self.made
        self.variable("Float64", "time", 0, "time", "s", causality="independent", variability="continuous")
        self._numbers()
        first = 1 + len(made.numbers)
        states, outputs = len(made.states), len(made.outputs)
        for i, state in enumerate(made.states):
            given = {"causality": "local", "variability": "continuous", "initial": "exact", "start": repr(made.begin[i])}
            self.variable("Float64", f"state.{state.name}", first + i, self.words(state), self.unit(state), **given)
        for i, state in enumerate(made.states):
            given = {"causality": "local", "variability": "continuous", "initial": "calculated", "derivative": str(first + i)}
            own = self.unit(state)
            rate = _UNIT_RATES.get(own, f"({own})/s" if own else "")
            self.variable("Float64", f"der(state.{state.name})", first + states + i, f"rate of the {self.words(state)}", rate, **given)
        calculated = {"initial": "calculated"}
        for i, output in enumerate(made.outputs):
            given = {"causality": "output", "variability": "continuous"} | calculated
            self.variable("Float64", output.name, first + 2 * states + i, self.words(output), self.unit(output), **given)
        for i in range(made.indicators):
            given = {"causality": "local", "variability": "continuous"} | calculated
            self.variable(
                "Float64", f"indicator[{i + 1}]", first + 2 * states + outputs + i, "falls to zero where an event is", "", **given
            )
        end = first + 2 * states + outputs + made.indicators
        single = len(made.contacts) == 1
        for i, contact in enumerate(made.contacts):
            given = {"causality": "output", "variability": "discrete"} | calculated
            what = f"1 if {contact} slips forwards, -1 backwards, 0 if it sticks"
            self.variable("Int32", "mode" if single else f"mode.{contact}", end + i, what, "", **given)
        given = {"causality": "output", "variability": "discrete"} | calculated
        self.variable("Int32", "events", end + len(made.contacts), "events since the start", "", **given)
        self._structure(first, end)
        return Described(self._document(name, identifier, token, version), *map(tuple, (self.inputs, self.outputs, self.parameters)))

    def _numbers(self) -> None:
        contacts = self.made.contacts
        taken = {"time", "events", *(output.name for output in self.made.outputs)}
        taken |= {"mode"} if len(contacts) == 1 else {f"mode.{contact}" for contact in contacts}
        taken |= {number.name for number in self.made.numbers if number.role == INPUT and not number.field}
        for i, number in enumerate(self.made.numbers):
            if not number.field and number.role != INPUT and number.name == "span":
                continue
            described = field_description(self.machine, number.field) if number.field else {}
            kind = "torque" if number.name.startswith("torque") else "force"
            words = str(described.get("label", "")) if number.field else f"{kind} that is applied"
            unit = str(described.get("unit", "")) if number.field else self.own_units["force"]
            causality = "input" if number.role == INPUT else "parameter"
            variability = "continuous" if number.role == INPUT else "fixed" if number.role == FIXED else "tunable"
            given = {"causality": causality, "variability": variability, "start": repr(number.value)}
            given |= {} if number.role == INPUT else {"initial": "exact"}
            own = f"{causality}.{number.name}" if number.field and number.name in taken else number.name
            self.variable("Float64", own, 1 + i, words, unit, **given)

    def words(self, quantity: Any) -> str:
        return _WORDS[quantity.kind].format(quantity.of or quantity.name)

    def unit(self, quantity: Any) -> str:
        return self.own_units.get(quantity.kind, "")

    def variable(self, kind: str, name: str, number: int, words: str, unit: str, **given: str) -> None:
        known = unit_named(unit) if unit and unit != "1" else None
        if known is not None:
            self.units[unit] = known
        description = {"description": words} if words else {}
        own = {"unit": unit} if known is not None else {}
        ElementTree.SubElement(self.variables, kind, {"name": name, "valueReference": str(number), **description, **given, **own})
        group = {"input": self.inputs, "output": self.outputs, "parameter": self.parameters}.get(given["causality"])
        if group is not None:
            group.append(name)

    def _structure(self, first: int, end: int) -> None:
        states, outputs = len(self.made.states), len(self.made.outputs)
        values = range(first + 2 * states, first + 2 * states + outputs)
        whole = range(end, end + len(self.made.contacts) + 1)
        rates = range(first + states, first + 2 * states)
        for which, numbers in (("Output", [*values, *whole]), ("ContinuousStateDerivative", rates), ("InitialUnknown", [*values, *whole])):
            for number in numbers:
                ElementTree.SubElement(self.structure, which, {"valueReference": str(number)})
        for number in rates:
            ElementTree.SubElement(self.structure, "InitialUnknown", {"valueReference": str(number)})
        for number in range(first + 2 * states + outputs, end):
            ElementTree.SubElement(self.structure, "EventIndicator", {"valueReference": str(number)})

    def _document(self, name: str, identifier: str, token: str, version: str) -> str:
        what = f"{type(self.machine).__name__}, solved by {self.made.method} steps"
        root = ElementTree.Element("fmiModelDescription", {
            "fmiVersion": "3.0", "modelName": name, "instantiationToken": token, "description": what,
            "generationTool": f"stickslip {version}", "variableNamingConvention": "flat",
        })  # fmt: skip
        can = {"canGetAndSetFMUState": "true", "canSerializeFMUState": "true", "providesDirectionalDerivatives": "true"}
        ElementTree.SubElement(root, "ModelExchange", {"modelIdentifier": identifier, **can, "needsCompletedIntegratorStep": "false"})
        ElementTree.SubElement(
            root, "CoSimulation",
            {"modelIdentifier": identifier, **can, "canHandleVariableCommunicationStepSize": "true", "hasEventMode": "true"},
        )  # fmt: skip
        if self.units:
            root.append(self._definitions())
        categories = ElementTree.SubElement(root, "LogCategories")
        for category, words in (("logEvents", "how a run ended"), ("logStatusError", "what was refused")):
            ElementTree.SubElement(categories, "Category", {"name": category, "description": words})
        length = self.made.period or self.made.span / AHEAD
        ElementTree.SubElement(
            root, "DefaultExperiment", {"startTime": "0", "stopTime": repr(10.0 * length), "stepSize": repr(length / 50.0)}
        )
        root.append(self.variables)
        root.append(self.structure)
        return _text(root)

    def _definitions(self) -> Any:
        definitions = ElementTree.Element("UnitDefinitions")
        for text, unit in self.units.items():
            base = {name: str(power) for name, power in zip(_BASE, unit.powers, strict=True) if power}
            factor = {} if unit.factor == 1.0 else {"factor": repr(unit.factor)}
            ElementTree.SubElement(ElementTree.SubElement(definitions, "Unit", {"name": text}), "BaseUnit", base | factor)
        return definitions


_UNIT_RATES = {"m": "m/s", "m/s": "m/s^2", "rad": "rad/s", "rad/s": "rad/s^2"}


def build_description(identifier: str) -> str:
    """Which sources make the library: one, which includes the others."""
    root = ElementTree.Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    build = ElementTree.SubElement(root, "BuildConfiguration", {"modelIdentifier": identifier})
    sources = ElementTree.SubElement(build, "SourceFileSet", {"language": "C99"})
    ElementTree.SubElement(sources, "SourceFile", {"name": "fmu.c"})
    return _text(root)


def _text(root: Any) -> str:
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"

# SPDX-License-Identifier: MIT
"""The stubs name what the module has: every class, member and function, with the parameters of each."""
import ast
import inspect
import pathlib
import re

import pytest

import flotilla
from flotilla import _core

PACKAGE = pathlib.Path(flotilla.__file__).parent
STUB = ast.parse((PACKAGE / "_core.pyi").read_text())
SPECIAL = {"__init__", "__len__", "__str__", "__eq__"}  # of the special methods, those that a caller thinks of


def parameters_of_stub(function):
    """Names in order, a star before those that must be named, and whether each has a default."""
    arguments = function.args
    missing = len(arguments.args) - len(arguments.defaults)
    out = [(a.arg, k >= missing) for k, a in enumerate(arguments.args)]
    if arguments.kwonlyargs:
        out.append(("*", False))
    out += [(a.arg, d is not None) for a, d in zip(arguments.kwonlyargs, arguments.kw_defaults)]
    return out + ([("**", False)] if arguments.kwarg else [])


def split(text):
    """At the commas outside of brackets and quotes."""
    parts, depth, quote = [""], 0, None
    for character in text:
        if quote:
            quote = None if character == quote else quote
        elif character in "'\"":
            quote = character
        depth += (character in "([{") - (character in ")]}") if not quote else 0
        if character == "," and depth == 0 and not quote:
            parts.append("")
        else:
            parts[-1] += character
    return [part.strip() for part in parts if part.strip()]


def parameters_of_module(function):
    """The same from the first line of the docstring, where pybind11 writes them."""
    text = re.match(r"\w+\((.*)\) -> ", function.__doc__.splitlines()[0])[1]
    out = []
    for part in split(text):
        if part == "*":
            out.append(("*", False))
        elif part.startswith("**"):
            out.append(("**", False))
        else:
            name = re.match(r"\w+", part)[0]
            out.append(("other" if name == "arg0" and out else "self" if name == "arg0" else name, " = " in part))
    return out


def stub_members(node):
    """Of a class: functions by name, and the names of attributes that can and cannot be set."""
    functions, settable, fixed = {}, set(), set()
    for item in node.body:
        if isinstance(item, ast.AnnAssign):
            (fixed if ast.unparse(item.annotation).startswith("Final[") else settable).add(item.target.id)
        elif isinstance(item, ast.FunctionDef):
            decorators = [ast.unparse(d) for d in item.decorator_list]
            if "property" in decorators:
                fixed.add(item.name)
            elif f"{item.name}.setter" in decorators:
                fixed.discard(item.name)
                settable.add(item.name)
            else:
                functions[item.name] = item
    return functions, settable, fixed


CLASSES = {node.name: node for node in STUB.body if isinstance(node, ast.ClassDef)}
FUNCTIONS = {node.name: node for node in STUB.body if isinstance(node, ast.FunctionDef)}


def test_names_of_the_module():
    public = {name: value for name, value in vars(_core).items() if not name.startswith("_")}
    assert set(CLASSES) == {name for name, value in public.items() if inspect.isclass(value)}
    assert {name for name in FUNCTIONS if not name.startswith("_")} == {
        name for name, value in public.items() if not inspect.isclass(value)}


@pytest.mark.parametrize("name", sorted(CLASSES))
def test_members_of_classes(name):
    functions, settable, fixed = stub_members(CLASSES[name])
    members = vars(getattr(_core, name))
    properties = {key: value for key, value in members.items() if isinstance(value, property)}
    assert settable == {key for key, value in properties.items() if value.fset}
    assert fixed == {key for key, value in properties.items() if not value.fset}
    methods = {key: value for key, value in members.items()
               if callable(value) and (not key.startswith("_") or key in SPECIAL)
               and (value.__doc__ or "").startswith(f"{key}(")}
    assert set(functions) == set(methods)
    for key, value in methods.items():
        assert parameters_of_stub(functions[key]) == parameters_of_module(value), key


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
def test_parameters_of_functions(name):
    assert parameters_of_stub(FUNCTIONS[name]) == parameters_of_module(getattr(_core, name))


def test_names_of_the_package():
    stub = ast.parse((PACKAGE / "__init__.pyi").read_text())
    imported = {alias.name for node in stub.body if isinstance(node, ast.ImportFrom) for alias in node.names} - {"*"}
    public = {name for name in [*CLASSES, *FUNCTIONS] if not name.startswith("_")}
    assert sorted(imported | public) == flotilla.__all__
    assert all(hasattr(flotilla, name) for name in flotilla.__all__)
    assert (PACKAGE / "py.typed").exists()


def test_everything_says_what_it_is():
    for name in flotilla.__all__:
        text = getattr(flotilla, name).__doc__
        assert text and (" " in text.strip()), name
    for name in CLASSES:
        for key, value in vars(getattr(_core, name)).items():
            if not key.startswith("_") and callable(value):
                assert len(value.__doc__.splitlines()) > 1, f"{name}.{key}"

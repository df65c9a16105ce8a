#!/usr/bin/python3
"""The manual pages and the shell completion, made from what the program itself says with --help.

  packaging/manual.py PROGRAM FOLDER      writes FOLDER/retalho.1.gz, FOLDER/retalho-COMMAND.1.gz, FOLDER/retalho.bash

An option whose help lists words ("--view KIND  plan (default) or perspective") is completed with them.
"""
import dataclasses
import gzip
import os
import pathlib
import re
import subprocess
import sys

KINDS = {"KIND", "AXIS", "VIEW"}  # argument names whose help is a list of words
FILES = {"FILE", "DEM", "M.retalho"}


def say(program, *words):
    return subprocess.run([program, *words], check=True, capture_output=True, text=True).stdout


@dataclasses.dataclass
class Option:
    names: list
    argument: str
    text: str

    def words(self):
        """The values that its text lists, empty where it lists none."""
        if not self.argument or self.argument.split("=")[0].split(" ")[0].rstrip(":.") not in KINDS | {"TEXT"}:
            return []
        text = re.sub(r"\([^)]*\)", "", self.text).split(". ")[0]
        found = []
        for sentence in text.split(";"):
            listed = sentence.split(":")
            # "Patches: shaded, lines": what stands in front of a colon is of what, or the words and their unit behind.
            for part in listed:
                words = [w.strip() for w in re.split(r",|\bor\b", part)]
                words = [w for w in words if w]
                if words and all(re.fullmatch(r"[a-z][a-z0-9-]*", w) for w in words):
                    found += [w for w in words if w not in found]
                    break
        return found if len(found) > 1 else []


@dataclasses.dataclass
class Page:
    name: str
    summary: str
    usage: str
    examples: list
    positionals: list
    groups: dict  # title: options


def parse(name, text):
    lines = text.split("\n")
    examples, summary, usage, positionals, groups, title, current = [], "", "", [], {}, "", None
    for line in lines:
        heading = re.fullmatch(r"([A-Z][A-Za-z ]*):", line)
        if heading:
            title, current = heading[1], None
        elif line.startswith("Usage: "):
            usage, title = line[len("Usage: "):], ""
        elif title == "Examples" and line.startswith("  "):
            examples.append(line.strip())
        elif not line.strip():
            title = "" if title == "Examples" else title
        elif not title and not line.startswith(" ") and not summary:
            summary = line.strip()
        elif title and re.match(r"  \S", line):
            # Two columns, or the second one on a line of its own.
            head, _, rest = re.match(r"  (\S.*?)(\s{2,}|$)(.*)", line).groups()
            if title in ("Positionals", "Subcommands"):
                current = Option([head.split(" ")[0]], "", rest)
                (positionals if title == "Positionals" else groups.setdefault(title, [])).append(current)
            else:
                names, _, argument = head.partition(" ")
                current = Option([n.split("{")[0] for n in names.split(",")], re.sub(r" REQUIRED| \.\.\.|\bTEXT:", "", argument), rest)
                groups.setdefault(title, []).append(current)
        elif title and current and line.startswith("   "):
            current.text = (current.text + " " + line.strip()).strip()
    if not summary or not usage:
        raise SystemExit(f"manual: cannot read the help of '{name}'")
    return Page(name, summary, usage, examples, positionals, groups)


def roff(text):
    return re.sub(r"^([.'])", r"\\&\1", text.replace("\\", "\\e").replace("-", "\\-"), flags=re.M)


def manual(page, version, commands):
    title = "retalho" + (f"-{page.name}" if page.name else "")
    out = [f'.TH {title.upper()} 1 "" "retalho {version}" "User Commands"', ".SH NAME", f"{roff(title)} \\- {roff(page.summary.rstrip('.'))}",
           ".SH SYNOPSIS", f".B {roff(page.usage)}"]
    if page.positionals:
        out.append(".SH ARGUMENTS")
        for p in page.positionals:
            out += [".TP", f".I {roff(p.names[0])}", roff(p.text) or roff(p.names[0])]
    for group, options in page.groups.items():
        out.append(f".SH {'COMMANDS' if group == 'Subcommands' else roff(group.upper())}")
        for o in options:
            argument = f" \\fI{roff(o.argument)}\\fR" if o.argument else ""
            out += [".TP", ", ".join(f"\\fB{roff(n)}\\fR" for n in o.names) + argument, roff(o.text) or "\\&"]
    out += [".SH EXAMPLES", ".nf", *[roff(e) for e in page.examples], ".fi", ".SH EXIT STATUS",
            "0 done; 1 failed inside; 2 usage; 3 bad input; 4 cannot read; 5 cannot write; 130 interrupted.",
            "Never 0 without the whole output; an output is complete or absent.", ".SH SEE ALSO"]
    others = ["retalho"] if page.name else [f"retalho-{c}" for c in commands]
    out.append(", ".join(f"\\fB{roff(o)}\\fR(1)" for o in others))
    return "\n".join(out) + "\n"


def completion(pages):
    lines = ["# Completion of retalho for bash; made from the program's own help.", "_retalho() {",
             "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command= options= words=", "  local k",
             "  for ((k = 1; k < COMP_CWORD; ++k)); do", "    [[ ${COMP_WORDS[k]} != -* ]] && command=${COMP_WORDS[k]} && break", "  done", "  case $command in"]
    for page in pages:
        options = [n for group in page.groups.values() for o in group for n in o.names if n.startswith("--")]
        lines += [f"    {page.name})", f"      options='{' '.join(options)}'", "      case $before in"]
        for group in page.groups.values():
            for o in group:
                if o.words():
                    lines.append(f"        {'|'.join(o.names)}) words='{' '.join(o.words())}' ;;")
        lines += ["      esac ;;"]
    names = " ".join(page.name for page in pages)
    lines += [f"    *) words='{names} --help --version' ;;", "  esac", '  if [[ -n $words ]]; then', '    COMPREPLY=($(compgen -W "$words" -- "$word"))',
              '  elif [[ $word == -* ]]; then', '    COMPREPLY=($(compgen -W "$options" -- "$word"))', "  else", '    COMPREPLY=($(compgen -f -- "$word"))', "  fi", "}",
              "complete -o filenames -F _retalho retalho"]
    return "\n".join(lines) + "\n"


def main():
    program, folder = os.path.abspath(sys.argv[1]), pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    version = say(program, "--version").split()[-1]
    root = parse("", say(program, "--help"))
    commands = [o.names[0] for o in root.groups["Subcommands"]]
    pages = [parse(c, say(program, c, "--help")) for c in commands]
    for page in [root, *pages]:
        name = "retalho" + (f"-{page.name}" if page.name else "") + ".1.gz"
        (folder / name).write_bytes(gzip.compress(manual(page, version, commands).encode(), 9, mtime=0))
    (folder / "retalho.bash").write_text(completion(pages))


if __name__ == "__main__":
    main()

"""Problems of a document, each with the path of the entry that it is about."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class EntryProblem:
    """A reason why an entry cannot be used; `text` names the entry, `words` is the text without its name.

    `path` leads to the entry from the document: keys, and indices from 0. It is empty where the problem is
    the whole document's.
    """

    path: tuple[str | int, ...]
    text: str
    words: str

    def within(self, entry: "DocumentEntry") -> "EntryProblem":
        """Return this problem for an entry below `entry`; a problem without a path stays as it is."""
        if not self.path:
            return self
        return EntryProblem((*entry.path, *self.path), entry.join(self.text), self.words)


@dataclass(frozen=True, slots=True)
class DocumentEntry:
    """An entry of a document: its name in error messages, and its path as in `EntryProblem`."""

    name: str = ""
    path: tuple[str | int, ...] = ()

    def field(self, name: str, shown: str = "") -> "DocumentEntry":
        """Return the field of this name in the table here; messages show `shown` instead if it is given."""
        return DocumentEntry(self.join(shown or name), (*self.path, name))

    def item(self, index: int) -> "DocumentEntry":
        """Return an entry of the list here; `index` from 0."""
        return DocumentEntry(f"{self.name}[{index}]", (*self.path, index))

    def key(self, key: str) -> "DocumentEntry":
        """Return the entry of this key in the dictionary here."""
        return DocumentEntry(f"{self.name}.{key}", (*self.path, key))

    def join(self, text: str) -> str:
        """Put the name before a text."""
        return f"{self.name}: {text}" if self.name else text

    def problem(self, text: str) -> EntryProblem:
        """Return a problem whose words continue the name: "is 5; it must be 4"."""
        return EntryProblem(self.path, f"{self.name} {text}", text)

    def sentence(self, text: str) -> EntryProblem:
        """Return a problem whose words are a sentence of their own."""
        return EntryProblem(self.path, self.join(text), text)

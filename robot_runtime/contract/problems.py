"""Problems of a document, each with the path of the entry that it is about."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class EntryProblem:
    """A reason why an entry cannot be used; `text` names the entry, `words` is the text without that name.

    `path` leads to the entry from the document: keys, and indices from 0. It is empty where the problem is
    the whole document's.
    """

    path: tuple[str | int, ...]
    text: str
    words: str

    def within(self, place: "DocumentEntry") -> "EntryProblem":
        """This problem of an entry below `place`; one without a path stays as it is."""
        if not self.path:
            return self
        return EntryProblem((*place.path, *self.path), place.join(self.text), self.words)


@dataclass(frozen=True, slots=True)
class DocumentEntry:
    """An entry of a document: its name in error messages, and its path as in `EntryProblem`."""

    name: str = ""
    path: tuple[str | int, ...] = ()

    def field(self, name: str, shown: str = "") -> "DocumentEntry":
        """The field of this name in the table here; messages show `shown` instead if it is given."""
        return DocumentEntry(self.join(shown or name), (*self.path, name))

    def item(self, index: int) -> "DocumentEntry":
        """An entry of the list here; `index` from 0."""
        return DocumentEntry(f"{self.name}[{index}]", (*self.path, index))

    def key(self, key: str) -> "DocumentEntry":
        """The entry of this key in the dictionary here."""
        return DocumentEntry(f"{self.name}.{key}", (*self.path, key))

    def join(self, text: str) -> str:
        """Puts the name before a text."""
        return f"{self.name}: {text}" if self.name else text

    def problem(self, words: str) -> EntryProblem:
        """A problem whose words continue the name: "is 5; it must be 4"."""
        return EntryProblem(self.path, f"{self.name} {words}", words)

    def sentence(self, words: str) -> EntryProblem:
        """A problem whose words are a sentence of their own."""
        return EntryProblem(self.path, self.join(words), words)

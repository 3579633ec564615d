"""Names of browsers and programs: what they may contain, and which of them look alike."""

from collections.abc import Collection
from unicodedata import category, normalize

NAME_LENGTH_MAX = 40

LOOK_ALIKES = {
    "a": "ɑαа⍺",
    "b": "ƄЬᏏᑲᖯ",
    "c": "сᴄⲥꮯ𐐽",
    "d": "ԁᏧᑯꓒ",
    "e": "еҽ℮ꬲ",
    "f": "քẝꞙꬵ",
    "g": "ƍɡցᶃ",
    "h": "һհᏂ",
    "i": "ıɩɪιіӏᎥ⍳ꙇꭵ𑣃",
    "j": "ϳј",
    "l": "ƖǀΙІӀ۱ᛁ∣⏽Ⲓⵏꓲ𐊊𐌉𐌠𖼨",
    "n": "ոռ",
    "o": "οσоօ۵०੦૦௦ం౦ಂ೦ംഠ൦ං๐໐ဝ၀ჿᴏᴑⲟꬽ𐐬𐓪𑣈𑣗",
    "p": "ρр⍴ⲣ",
    "q": "ԛգզ",
    "r": "гᴦⲅꭇꭈꮁ",
    "s": "ƽѕꜱꮪ𐑈𑣁",
    "u": "ʋυսᴜꞟꭎꭒ𐓶𑣘",
    "v": "νѵᴠ∨⋁ꮩ𑜆𑣀",
    "w": "ɯѡԝաᴡꮃ𑜊𑜎𑜏",
    "x": "×хᕁᕽ᙮⤫⤬⨯",
    "y": "ɣʏγуүყᶌỿꭚ𑣜",
    "z": "ᴢꮓ𑣄",
    "A": "ΑАᎪᗅꓮ𐊠𖽀",
    "B": "ΒВᏴᗷꓐꞴ𐊂𐊡𐌁",
    "C": "СᏟⲤꓚ𐊢𐌂𐐕𐔜𑣩𑣲🝌",
    "D": "Ꭰᗞᗪꓓ",
    "E": "ΕЕᎬ⋿ⴹꓰ𐊆𑢦𑢮",
    "F": "ϜᖴꓝꞘ𐊇𐊥𐔥𑢢𑣂𝈓",
    "G": "ԌᏀᏳꓖ",
    "H": "ΗНᎻᕼⲎꓧ𐋏",
    "J": "ͿЈᎫᒍꓙꞲ",
    "K": "ΚКᏦᛕⲔꓗ𐔘",
    "L": "ᏞᒪⳐꓡ𐐛𐔦𑢣𑢲𖼖𝈪",
    "M": "ΜϺМᎷᗰᛖⲘꓟ𐊰𐌑",
    "N": "ΝⲚꓠ𐔓",
    "O": "ΟОՕ০ଠ୦ዐⲞⵔ〇ꓳ𐊒𐊫𐐄𐓂𐔖𑓐𑢵𑣠",
    "P": "ΡРᏢᑭⲢꓑ𐊕",
    "Q": "ⵕ",
    "R": "ƦᎡᏒᖇꓣ𐒴𖼵𝈖",
    "S": "ЅՏᏕᏚꓢ𐊖𐐠𖼺",
    "T": "ΤТᎢ⊤⟙Ⲧꓔ𐊗𐊱𐌕𑢼𖼊🝨",
    "U": "Սሀᑌ∪⋃ꓴ𐓎𑢸𖽂",
    "V": "Ѵ۷Ꮩᐯⴸꓦꛟ𐔝𑢠𖼈𝈍",
    "W": "ԜᎳᏔꓪ𑣦𑣯",
    "X": "ΧХ᙭ᚷ╳ⲬⵝꓫꞳ𐊐𐊴𐌗𐌢𐔧𑣬",
    "Y": "ΥУҮᎩᎽⲨꓬ𐊲𑢤𖽃",
    "Z": "ΖᏃꓜ𐋵𑢩𑣥",
    "2": "ƧϨᒿꙄꛯꝚ",
    "3": "ƷȜЗӠⳌꝪꞫ𑣊𖼻𝈆",
    "4": "Ꮞ𑢯",
    "5": "Ƽ𑢻",
    "6": "бᏮⳒ𑣕",
    "7": "𐓒𑣆𝈒",
    "8": "Ȣȣ৪੪ଃ𐌚",
    "9": "৭੧୨൭ⳊꝮ𑢬𑣌𑣖",
    "-": "˗‐‒–⁃−➖Ⲻ",
    ".": "۰ꓸ꘎𝅭",
    "'": "ʹʻʼʽʾˈˊˋ˴՚՝ᑊᛌ‘’‛′‵ꞌ𖽑𖽒",
}
"""Characters that look like a letter, digit or sign of ASCII: from `confusables` of Unicode's UTS #39, those
that NFKC leaves as they are."""
_ASCII_LOOKS = {"I": "l", "1": "l", "|": "l", "0": "O"}
_LOOKS = str.maketrans(_ASCII_LOOKS | {one: look for look, many in LOOK_ALIKES.items() for one in many})

_UNSEEN = frozenset("\u034f\u115f\u1160\u17b4\u17b5\u180b\u180c\u180d\u180f\u2800\U0001d159")
_SELECTORS = (range(0xFE00, 0xFE10), range(0xE0100, 0xE01F0))
"""Characters that count as printable and show nothing, such as Hangul's fillers, and variation selectors."""


def clean_name(name: str) -> str:
    """A name in the form in which it is stored: NFKC, single spaces. Raises ValueError."""
    name = " ".join(normalize("NFKC", name).split())
    if not name or not name.isprintable() or any(map(_is_unseen, name)):
        raise ValueError("must have visible characters, and no control characters")
    if any(category(word[0]).startswith("M") for word in name.split()):
        raise ValueError("must not begin a word with an accent that has no letter")
    if len(name) > NAME_LENGTH_MAX:
        raise ValueError(f"must have {NAME_LENGTH_MAX} characters at most, ligatures written out")
    return name


def find_alike(name: str, others: Collection[str]) -> str | None:
    """The first of the others that looks like this name, or is it in other case; None where none does."""
    looks = _looks(name)
    return next((other for other in others if looks & _looks(other)), None)


def number_name(name: str, others: Collection[str]) -> str:
    """This name, or with the first number from 2 on with which it looks like none of the others."""
    taken = frozenset[str]().union(*map(_looks, others))
    numbered, number = name, 1
    while not taken.isdisjoint(_looks(numbered)):
        number += 1
        end = f" {number}"
        numbered = name[: NAME_LENGTH_MAX - len(end)].rstrip() + end
    return numbered


def _looks(name: str) -> frozenset[str]:
    """The looks of a name, as it is and in lower case: "Ina" looks like "lna", and is "ina"."""
    return frozenset(_skeleton(one).casefold() for one in (name, name.casefold()))


def _skeleton(name: str) -> str:
    return normalize("NFD", normalize("NFD", name).translate(_LOOKS)).replace("rn", "m")


def _is_unseen(character: str) -> bool:
    return character in _UNSEEN or any(ord(character) in selectors for selectors in _SELECTORS)

"""Film: the camera's pictures, recorded with a session."""

from server.feature import Feature
from server.features.film.config import FilmConfig

FEATURE = Feature(
    name="film",
    section=FilmConfig,
    routes=("server.features.film.routes:router",),
    plug="server.features.film.plug:FilmPlug",
)

"""Film: the camera's pictures, recorded with a session."""

from server.feature import Feature

FEATURE = Feature(
    name="film",
    section="server.features.film.config:FilmConfig",
    routes=("server.features.film.routes:router",),
    plug="server.features.film.plug:FilmPlug",
)

"""The HTTP floor: serving, the page, security headers, sign-in."""

/** Colours of sessions, after Okabe and Ito: told apart by colour-blind eyes, and legible on the theme's ground. */
const ON_DARK = ['#56b4e9', '#e69f00', '#cc79a7', '#2fbf8f', '#f0e442', '#e8743b', '#a6b8c4'];
const ON_LIGHT = ['#0072b2', '#c25200', '#a3427d', '#00795a', '#7d6a00', '#5b3fa0', '#4a5a66'];

export function sessionColour(place: number, theme: 'dark' | 'sunlight'): string {
  const colours = theme === 'dark' ? ON_DARK : ON_LIGHT;
  return colours[place % colours.length] ?? '#888888';
}

// Plain text of the program as it is printed.

const kRaised = '⁰¹²³⁴⁵⁶⁷⁸⁹';

/** "10^-12", "x = -2 mm" and "+- 3 um" as a reader expects them. */
export const printed = (text) => text.replaceAll('+-', '±').replace(/\bum\b/g, 'µm').replace(/\burad\b/g, 'µrad').replace(/(= |log10 p )-(?=\d)/g, '$1−')
  .replace(/\bchi2\b/g, 'χ²').replace(/10\^(-?)(\d+)/g, (_, sign, digits) => `10${sign ? '⁻' : ''}${[...digits].map((digit) => kRaised[digit]).join('')}`);

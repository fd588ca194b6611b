// Plain text of the program as it is printed.

const kRaised = '⁰¹²³⁴⁵⁶⁷⁸⁹';

/** "10^-12", "urad/mm3", "x = -2 mm" and "+- 3 um" as a reader expects them. */
export const printed = (text) => text.replaceAll('+-', '±').replace(/\bum\b/g, 'µm').replace(/\burad\b/g, 'µrad').replace(/(= |log10 p )-(?=\d)/g, '$1−')
  .replace(/\/(mm|m|deg|K)([2-9])\b/g, (_, unit, power) => `/${unit}${kRaised[power]}`)
  .replace(/\bchi2\b/g, 'χ²').replace(/10\^(-?)(\d+)/g, (_, sign, digits) => `10${sign ? '⁻' : ''}${[...digits].map((digit) => kRaised[digit]).join('')}`);

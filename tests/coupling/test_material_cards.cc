#include "tests/coupling/card_reading.h"

using namespace coupling;

namespace {

const std::vector<fem::LawRecord> records{
    cards::isotropic_record(true), cards::isotropic_record(false), cards::anisotropic_record()};

IsotropicRelaxation read_ansys(const std::string& text, double stress)
{
  PronySeries series;
  double young = 0, poisson = 0;
  bool shear = true, prony = false;
  for (const std::string& line : cards::lines_of(text)) {
    if (line.starts_with("MP,EX,1,"))
      young = reference::number(line.substr(8));
    else if (line.starts_with("MP,PRXY,1,"))
      poisson = reference::number(line.substr(10));
    else if (line.starts_with("TB,")) {
      prony = line.starts_with("TB,PRONY");
      shear = line.ends_with("SHEAR");
    } else if (prony && line.starts_with("TBDATA,")) {
      const auto row = cards::numbers(line.substr(7));
      series.terms.push_back(shear ? PronyTerm{row.at(2), row.at(1), 0}
                                   : PronyTerm{row.at(2), 0, row.at(1)});
    }
  }
  return cards::moduli(stress * young, poisson, series);
}

IsotropicRelaxation read_ls_dyna(const std::string& text, double stress)
{
  const auto lines = cards::lines_of(text);
  IsotropicRelaxation result;
  const auto add = [&](fem::RelaxationModulus& modulus, double part, double rate) {
    if (rate > 0)
      modulus.parts.push_back({1 / rate, stress * part});
    else
      modulus.equilibrium += stress * part;
  };
  for (std::size_t i = cards::find(lines, "$       gi     betai") + 1; lines.at(i) != "*END"; ++i) {
    EXPECT_EQ(lines[i].size(), 40U);
    std::vector<double> fields;
    for (std::size_t k = 0; k < 4; ++k)
      fields.push_back(cards::numbers(lines[i].substr(10 * k, 10)).at(0));
    add(result.shear, fields[0], fields[1]);
    add(result.bulk, fields[2], fields[3]);
  }
  return result;
}

/// The compliance law of a MOOSE block.
fem::ComplianceLaw read_moose(const std::string& text, double stress)
{
  const auto lines = cards::lines_of(text);
  const auto values = [&](const std::string& key) {
    std::string line = lines.at(cards::find(lines, "    " + key + " = "));
    line = line.substr(line.find('=') + 1);
    return cards::numbers(line.substr(0, line.find('#')));
  };
  const double young = stress * values("young_modulus").at(0);
  const double poisson = values("poisson_ratio").at(0);
  const auto springs = values("creep_modulus"), ratios = values("creep_ratio"),
             times = values("creep_viscosity");
  std::vector<fem::RetardationTerm> terms;
  for (std::size_t k = 0; k < times.size(); ++k)
    terms.push_back({times[k], fem::isotropic_shape(ratios.at(k)) / (stress * springs.at(k))});
  return {fem::isotropic_shape(poisson) / young, fem::Mat6::Zero(), terms};
}

double difference(const fem::ComplianceLaw& a, const fem::ComplianceLaw& b)
{
  double largest = 0;
  for (double t = 0.01; t < 1e4; t *= 1.5)
    largest = std::max(largest, tables::difference(fem::compliance(a, t), fem::compliance(b, t)));
  return largest;
}

} // namespace

TEST(MaterialCards, NumbersOfEachProgramMakeTheLawAgain)
{
  for (const CardUnits& units : {si_units(), millimetre_units()})
    for (const fem::LawRecord& record : records) {
      const auto card = [&](CardFormat format) { return material_card(record, format, units); };
      const MaterialCard abaqus = card(CardFormat::abaqus), ansys = card(CardFormat::ansys),
                         dyna = card(CardFormat::ls_dyna), moose = card(CardFormat::moose);
      const auto read = [&](const MaterialCard& from, const char* name) {
        return cards::text_of(from.files, name);
      };
      EXPECT_LT(cards::creep_difference(
                    cards::read_abaqus(read(abaqus, "mastic_abaqus.inp"), units.stress),
                    abaqus.represented),
                1e-6);
      EXPECT_LT(cards::creep_difference(read_ansys(read(ansys, "mastic_ansys.inp"), units.stress),
                                        ansys.represented),
                1e-6);
      EXPECT_LT(cards::creep_difference(read_ls_dyna(read(dyna, "mastic_ls_dyna.k"), units.stress),
                                        dyna.represented),
                1e-3);
      EXPECT_LT(
          difference(read_moose(read(moose, "mastic_moose.i"), units.stress), moose.represented),
          1e-9);
    }
}

TEST(MaterialCards, IsotropicLawsAreRepresented)
{
  for (const CardFormat format : {CardFormat::abaqus, CardFormat::ansys, CardFormat::ls_dyna,
                                  CardFormat::mfront, CardFormat::moose, CardFormat::tables}) {
    EXPECT_LT(material_card(records[0], format, si_units()).creep_error, 1e-6);
    EXPECT_LT(material_card(records[1], format, si_units()).creep_error, 1.1e-4);
  }
}

TEST(MaterialCards, StatedErrorIsFoundInTheCheckTable)
{
  const MaterialCard card = material_card(records[2], CardFormat::abaqus, si_units());
  EXPECT_GT(card.creep_error, 1e-3);
  const auto lines = cards::lines_of(cards::text_of(card.files, "mastic_abaqus_check.inp"));
  const std::size_t head = cards::find(lines, "**         time_s");
  for (std::size_t i = head + 1; i <= head + 7; ++i) {
    const auto row = cards::numbers(lines.at(i).substr(2));
    const fem::Mat6 of_card = fem::compliance(card.represented, row.at(0));
    const fem::Mat6 of_law = fem::compliance(records[2].law, row.at(0));
    EXPECT_NEAR(row.at(1) / (1e5 * of_card(0, 0)), 1, 1e-5);
    EXPECT_NEAR(row.at(2) / (1e5 * of_card(1, 0)), 1, 1e-5);
    EXPECT_NEAR(row.at(3) / (1e5 * of_law(0, 0)), 1, 1e-5);
    EXPECT_LE(std::abs(row.at(1) / row.at(3) - 1), card.creep_error * (1 + 1e-6));
  }
}

TEST(MaterialCards, LinesFitTheProgram)
{
  for (const fem::LawRecord& record : records) {
    const auto lines = [&](CardFormat format, const char* name) {
      return cards::lines_of(cards::text_of(material_card(record, format, si_units()).files, name));
    };
    for (const std::string& line : lines(CardFormat::abaqus, "mastic_abaqus_check.inp"))
      EXPECT_LE(line.size(), 256U) << line;
    for (const std::string& line : lines(CardFormat::abaqus, "mastic_abaqus.inp")) {
      EXPECT_LE(line.size(), 256U) << line;
      EXPECT_TRUE(line[0] == '*' || std::ranges::count(line, ',') <= 7) << line;
    }
    for (const char* name : {"mastic_ls_dyna.k", "mastic_ls_dyna_check.k"})
      for (const std::string& line : lines(CardFormat::ls_dyna, name))
        EXPECT_TRUE(line[0] == '$' || line.size() <= 80) << line;
  }
}

TEST(MaterialCards, CarryTheTemperatureShiftOrSayThatTheyDoNot)
{
  fem::LawRecord record = records[0];
  const auto abaqus = [&] {
    return cards::text_of(material_card(record, CardFormat::abaqus, si_units()).files,
                          "mastic_abaqus.inp");
  };
  EXPECT_NE(abaqus().find("*TRS, DEFINITION=WLF\n2.9315"), std::string::npos);
  record.shift = fem::ArrheniusShift{2e5, 293.15};
  EXPECT_NE(abaqus().find("*TRS, DEFINITION=ARRHENIUS"), std::string::npos);
  record.shift = fem::FreeShift{{277.15, 293.15, 310}, {1.9, 0, -1.5}, 293.15};
  EXPECT_EQ(abaqus().find("*TRS"), std::string::npos);
  EXPECT_NE(material_card(record, CardFormat::abaqus, si_units()).limits.find("shift is not in"),
            std::string::npos);
  EXPECT_EQ(material_card(record, CardFormat::mfront, si_units()).limits.find("shift is not in"),
            std::string::npos);
}

TEST(MaterialCards, TablesHoldTheLaw)
{
  const fem::LawRecord& record = records[2];
  const MaterialCard card = material_card(record, CardFormat::tables, si_units());
  const auto creep = cards::lines_of(cards::text_of(card.files, "creep_compliance.csv"));
  EXPECT_EQ(creep[0], "reduced_time_s,D_1_1_per_GPa,D_2_1_per_GPa,D_3_1_per_GPa,"
                      "D_isotropic_1_per_GPa");
  for (std::size_t i = 1; i < creep.size(); ++i) {
    const auto row = cards::numbers(creep[i]);
    EXPECT_NEAR(row.at(2), 1e9 * fem::compliance(record.law, row.at(0))(1, 1), 1e-9 * row.at(2));
  }
  const auto modulus = cards::lines_of(cards::text_of(card.files, "dynamic_modulus.csv"));
  for (std::size_t i = 1; i < modulus.size(); ++i) {
    const auto row = cards::numbers(modulus[i]);
    const double shifted = row.at(1) * fem::shift_factor(record.shift, row.at(0) + 273.15);
    EXPECT_NEAR(row.at(2) / shifted, 1, 1e-4);
    const auto exact = fem::complex_compliance(record.law, 2 * M_PI * row.at(2));
    EXPECT_NEAR(row.at(3) * 1e6 * std::abs(exact(0, 0)), 1, 1e-9);
    EXPECT_NEAR(row.at(7), -180 / M_PI * std::arg(exact(0, 0)), 1e-7);
  }
}

TEST(MaterialCards, DoNotDependOnTheUnits)
{
  const MaterialCard si = material_card(records[1], CardFormat::abaqus, si_units());
  const MaterialCard mm = material_card(records[1], CardFormat::abaqus, millimetre_units());
  const IsotropicRelaxation a =
      cards::read_abaqus(cards::text_of(si.files, "mastic_abaqus.inp"), si_units().stress);
  const IsotropicRelaxation b =
      cards::read_abaqus(cards::text_of(mm.files, "mastic_abaqus.inp"), millimetre_units().stress);
  for (double t = 0.01; t < 1e4; t *= 3)
    EXPECT_NEAR(fem::value(a.shear, t) / fem::value(b.shear, t), 1, 1e-9);
}

TEST(MaterialCards, RefuseWhatCannotBeWritten)
{
  const auto refusal = [](const fem::LawRecord& record, CardFormat format) -> std::string {
    try {
      material_card(record, format, si_units());
    } catch (const std::invalid_argument& problem) {
      return problem.what();
    }
    return "accepted";
  };
  fem::LawRecord record = records[0];
  record.law.terms.clear();
  for (const NamedCardFormat& format : card_formats())
    EXPECT_EQ(refusal(record, format.format).substr(0, 18), "the law is elastic");
  record.law.fluidity = 1e-3 * record.law.instantaneous;
  for (const NamedCardFormat& format : card_formats())
    EXPECT_EQ(refusal(record, format.format), "accepted") << format.name;
  IsotropicCreep creep{{1e-9, 0, {}}, {1e-9, 0, {}}};
  for (int k = 0; k < 20; ++k)
    creep.shear.parts.push_back({std::pow(3.0, k), 1e-9});
  record.law = compliance_law(creep);
  EXPECT_EQ(refusal(record, CardFormat::ls_dyna),
            "LS-DYNA takes 18 relaxation terms and this law has 21; fit a law with fewer "
            "retardation times");
  EXPECT_EQ(refusal(record, CardFormat::abaqus), "accepted");
}

TEST(PfcCard, GivesTheConstantsOfTheBond)
{
  const dem::BondLaw law{dem::burgers(3e6, 6e7, 1e6, 2e6), 11, 1};
  const ContactCard card = pfc_card(law, 0.7, 100);
  EXPECT_LT(card.creep_error, 1e-14);
  const auto lines = cards::lines_of(cards::text_of(card.files, "mastic_pfc.dat"));
  const auto value = [&](const std::string& name) {
    std::string line = lines.at(cards::find(lines, "  " + name + " "));
    return cards::numbers(line.substr(name.size() + 3, 18)).at(0);
  };
  EXPECT_EQ(value("bur_knm"), 3e6);
  EXPECT_EQ(value("bur_cnm"), 6e7);
  EXPECT_EQ(value("bur_knk"), 1e6);
  EXPECT_EQ(value("bur_cnk"), 2e6);
  EXPECT_NEAR(value("bur_ksm"), 3e6 / 11, 1e-5);
  EXPECT_NEAR(value("bur_csm"), 6e7 / 11, 1e-4);
  EXPECT_NEAR(value("bur_ksk"), 1e6 / 11, 1e-5);
  EXPECT_NEAR(value("bur_csk"), 2e6 / 11, 1e-5);
  EXPECT_EQ(value("bur_fric"), 0.7);
}

TEST(PfcCard, MakesMissingPartsStiff)
{
  const std::vector<dem::KelvinBranch> branch{{1e6, 2e6}};
  const ContactCard solid = pfc_card({dem::make_creep_law(3e6, {}, branch), 11, 1}, 0.7, 100);
  EXPECT_GT(solid.creep_error, 0);
  EXPECT_LT(solid.creep_error, 2e-6);
  const ContactCard maxwell = pfc_card({dem::make_creep_law(3e6, 6e7, {}), 11, 1}, 0.7, 100);
  EXPECT_LT(maxwell.creep_error, 2e-6);
  const std::vector<dem::KelvinBranch> two{{1e6, 2e6}, {1e6, 2e8}};
  EXPECT_THROW(pfc_card({dem::make_creep_law(3e6, {}, two), 11, 1}, 0.7, 100),
               std::invalid_argument);
}
